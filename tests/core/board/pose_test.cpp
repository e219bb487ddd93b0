#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "core/board/board.h"

namespace ca2 {
namespace {

Board board_8x6() {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = 8;
  board.rows = 6;
  board.square = 0.04;
  return board;
}

Camera camera_of(const char* model, std::initializer_list<double> parameters, int width, int height) {
  Camera camera;
  camera.model = find_camera_model(model);
  camera.parameters.resize(static_cast<Eigen::Index>(parameters.size()));
  std::copy(parameters.begin(), parameters.end(), camera.parameters.data());
  camera.width = width;
  camera.height = height;
  return camera;
}

Camera narrow() {
  return camera_of("pinhole_radtan", {1250, 1252, 694, 519, -0.1, 0.05, 1e-3, -5e-4, 0.01}, 1388, 1038);
}

/// 220 degrees across the picture's diagonal: more than half a turn.
Camera wide() {
  return camera_of("kannala_brandt", {265, 265, 424, 400, -0.005, 0.001, 0, 0}, 848, 800);
}

/// A board at `distance` in direction `bearing`, turned about its own axes, facing the camera.
Pose pose_towards(const Eigen::Vector3d& bearing, double distance, const Eigen::Vector3d& turn) {
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), bearing).toRotationMatrix();
  return {R * so3_exp(turn), bearing.normalized() * distance};
}

std::vector<Corner> seen(const Board& board, const Camera& camera, const Pose& T_camera_board, double sigma,
                         std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Corner> corners;
  for (const Eigen::Vector2d& p : board.type->corners(board)) {
    const auto pixel = camera.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0));
    const int id = static_cast<int>(corners.size());
    corners.push_back({id, *pixel + sigma * Eigen::Vector2d(normal(random), normal(random)),
                       Eigen::Matrix2d::Identity() * sigma * sigma});
  }
  return corners;
}

TEST(BoardPose, IsExactWithoutNoise) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const Board board = board_8x6();
  for (int i = 0; i < 200; ++i) {
    const bool fisheye = i % 2 == 0;
    const Camera camera = fisheye ? wide() : narrow();
    const double off_axis = (fisheye ? 1.75 : 0.35) * std::abs(unit(random));  // up to 100 degrees
    const double around = M_PI * unit(random);
    const Eigen::Vector3d bearing(std::sin(off_axis) * std::cos(around),
                                  std::sin(off_axis) * std::sin(around), std::cos(off_axis));
    const Eigen::Vector3d turn(unit(random), unit(random), 3 * unit(random));
    const Pose truth = pose_towards(bearing, fisheye ? 0.8 : 2, turn);
    std::vector<Corner> corners;
    for (Corner& corner : seen(board, camera, truth, 0, random)) {
      corner.covariance = Eigen::Matrix2d::Identity() * 0.01;
      corners.push_back(corner);
    }
    const auto pose = estimate_board_pose(board, camera, corners);
    ASSERT_TRUE(pose) << pose.error().text();
    EXPECT_LT(truth.difference(pose->T_camera_board).norm(), 1e-7) << off_axis;
    EXPECT_LT(pose->reprojection_rms, 1e-6);
  }
}

/// Error over covariance: its mean over 6 dimensions is 1 for an honest covariance.
TEST(BoardPose, CovarianceIsWhatSamplingFinds) {
  std::mt19937_64 random(2);
  const Board board = board_8x6();
  for (const bool fisheye : {false, true}) {
    const Camera camera = fisheye ? wide() : narrow();
    const Pose truth = pose_towards(fisheye ? Eigen::Vector3d(1, 0.3, 0.1) : Eigen::Vector3d(0.1, 0.1, 1),
                                    fisheye ? 0.8 : 2, {0.5, -0.4, 1});
    const int trials = 400;
    double sum = 0;
    for (int i = 0; i < trials; ++i) {
      const auto pose = estimate_board_pose(board, camera, seen(board, camera, truth, 0.05, random));
      ASSERT_TRUE(pose);
      const Vector6d error = truth.difference(pose->T_camera_board);
      sum += error.dot(pose->covariance.inverse() * error) / 6;
    }
    // Mean of a chi-square per degree: sigma = sqrt(2 / (6 * 400)) = 0.03. The inflation by bad luck only
    // (never deflation) takes a few per cent.
    EXPECT_GT(sum / trials, 0.82) << fisheye;
    EXPECT_LT(sum / trials, 1.10) << fisheye;
  }
}

/// Small and far the two planar solutions look alike: the right one must win as often as the noise allows.
TEST(BoardPose, ChoosesTheRightSolution) {
  std::mt19937_64 random(3);
  const Board board = board_8x6();
  int wrong = 0;
  for (int i = 0; i < 200; ++i) {
    const Pose truth = pose_towards({0.05, -0.1, 1}, 3, {0.5, 0.3, 0.02 * i});
    const auto pose = estimate_board_pose(board, narrow(), seen(board, narrow(), truth, 0.1, random));
    ASSERT_TRUE(pose);
    wrong += truth.difference(pose->T_camera_board).head<3>().norm() > 0.3;
  }
  EXPECT_EQ(wrong, 0);
}

TEST(BoardPose, SaysWhyThereIsNone) {
  std::mt19937_64 random(4);
  const Board board = board_8x6();
  const Pose truth = pose_towards({0, 0, 1}, 2, {0.4, 0, 0});
  const std::vector<Corner> corners = seen(board, narrow(), truth, 0.1, random);
  const auto few = estimate_board_pose(board, narrow(), std::span(corners).first(3));
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, ErrorCode::data);
  const auto line = estimate_board_pose(board, narrow(), std::span(corners).first(8));
  ASSERT_FALSE(line);
  EXPECT_NE(line.error().text().find("line"), std::string::npos);
  std::vector<Corner> unknown = corners;
  for (Corner& corner : unknown) corner.id += 100;
  EXPECT_FALSE(estimate_board_pose(board, narrow(), unknown));
}

}  // namespace
}  // namespace ca2
