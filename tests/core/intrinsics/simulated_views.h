// Views of a checkerboard, carried through a camera's picture, with noisy corners.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "core/board/board.h"
#include "core/geometry/pose.h"
#include "tests/core/camera/examples.h"

namespace ca2::test {

inline Board checkerboard() {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = 8;
  board.rows = 6;
  board.square = 0.04;
  return board;
}

struct SimulatedViews {
  std::vector<Pose> poses;  ///< T_camera_board
  std::vector<std::vector<Corner>> corners;
};

/// `count` views whose boards lie wholly in the picture: places all over it, tilts up to `tilt` [rad] off the
/// line of sight, or all parallel to the picture plane (`parallel`). Noise of `sigma` px, whose covariance
/// claims `claimed` px. No corner is more than `rim` [rad] off the axis, where a lens' image circle ends.
inline SimulatedViews simulate_views(const Camera& camera, int count, double sigma, double claimed,
                                     std::mt19937_64& rng, double tilt = 0.7, bool parallel = false,
                                     double rim = 1.43) {
  const Board board = checkerboard();
  const std::vector<Eigen::Vector2d> points = board.type->corners(board);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  // Metres at which the board fills about a third of the picture's width.
  const auto left = camera.unproject({camera.width / 3.0, camera.height / 2.0});
  const auto right = camera.unproject({camera.width * 2 / 3.0, camera.height / 2.0});
  const double usual = 0.3 / std::acos(left->dot(*right));
  SimulatedViews views;
  while (views.corners.size() < static_cast<std::size_t>(count)) {
    const Eigen::Vector2d target = random_pixel(camera, rng);
    const double distance = usual * (1 + 0.4 * uniform(rng));
    const double x = tilt * uniform(rng), y = tilt * uniform(rng), roll = uniform(rng);
    const auto ray = camera.unproject(target);
    if (!ray) continue;
    Pose pose;
    pose.t = *ray * distance;
    const Eigen::Matrix3d facing =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray).toRotationMatrix();
    pose.R = parallel ? so3_exp({0, 0, roll})
                      : Eigen::Matrix3d(facing * so3_exp({x, y, 0}) * so3_exp({0, 0, roll}));
    std::vector<Corner> corners;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = pose * Eigen::Vector3d(points[i].x(), points[i].y(), 0);
      if (std::atan2(p.head<2>().norm(), p.z()) > rim) break;
      const auto pixel = camera.project(p);
      if (!pixel || !camera.contains(*pixel, 2)) break;
      Corner corner;
      corner.id = static_cast<int>(i);
      const double u = normal(rng);
      corner.pixel = *pixel + sigma * Eigen::Vector2d(u, normal(rng));
      corner.covariance = Eigen::Matrix2d::Identity() * claimed * claimed;
      corners.push_back(corner);
    }
    if (corners.size() != points.size()) continue;
    views.poses.push_back(pose);
    views.corners.push_back(std::move(corners));
  }
  return views;
}

}  // namespace ca2::test
