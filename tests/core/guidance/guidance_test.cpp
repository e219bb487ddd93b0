#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <random>

#include "core/geometry/scaled_inverse.h"
#include "core/guidance/candidate_poses.h"
#include "core/guidance/choose_views.h"
#include "core/guidance/next_pose.h"
#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

SightModel model() {
  SightModel m;
  m.board = test::make_board("checkerboard", 8, 6);
  m.board.outline = Outline{0.42, 0.297, {0, 0}};
  m.camera = test::narrow_camera();
  m.T_camera_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  m.T_camera_lidar.t = {0.05, -0.1, -0.08};
  m.returns_per_steradian = 20000;
  return m;
}

Pose facing(double x, double y, double distance, const Eigen::Vector3d& turn) {
  return {so3_exp(turn), Eigen::Vector3d(x, y, 1).normalized() * distance};
}

/// Bias and board drawn anew, T estimated from exact first-order measurements: what the information promises
/// is what the estimator of a small linear problem gets.
TEST(ViewInformation, AgreesWithTheCovarianceOfALinearEstimate) {
  const SightModel m = model();
  const Pose T_camera_board = facing(0.1, -0.05, 1.5, {0.4, 0.3, 0.1});
  // Numerical derivatives of the very measurements: corner pixels and ranges to the board's plane.
  const Pose T_lidar_camera = m.T_camera_lidar.inverse();
  const auto measure = [&](const Eigen::Matrix<double, 13, 1>& d) {
    const Pose T_cl = m.T_camera_lidar.perturbed(d.head<6>());
    const Pose T_cb = T_camera_board.perturbed(d.segment<6>(7));
    std::vector<double> values;
    for (const Eigen::Vector2d& p : m.board.type->corners(m.board)) {
      const Eigen::Vector2d pixel = *m.camera.project(T_cb * Eigen::Vector3d(p.x(), p.y(), 0));
      values.push_back(pixel.x() / m.corner_sigma);
      values.push_back(pixel.y() / m.corner_sigma);
    }
    const Pose T_lb = T_cl.inverse() * T_cb;
    const Eigen::Vector3d normal = T_lb.R.col(2);
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) {
        const Eigen::Vector3d on_board((i - 2.5) / 6 * 0.42, (j - 2.5) / 6 * 0.297, 0);
        const Eigen::Vector3d ray = (T_lidar_camera * (T_camera_board * on_board)).normalized();
        const double range = normal.dot(T_lb.t) / normal.dot(ray) + d(6);
        const Pose T_lb0 = T_lidar_camera * T_camera_board;
        const double facing_share = std::abs(T_lb0.R.col(2).dot(T_lb0.t)) / T_lb0.t.norm();
        const double count =
            m.returns_per_steradian * 0.42 * 0.297 * facing_share / T_lb0.t.squaredNorm() / 36;
        values.push_back(range * std::sqrt(count) / m.range_sigma);
      }
    }
    return Eigen::VectorXd(
        Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  Eigen::MatrixXd J(measure(Eigen::Matrix<double, 13, 1>::Zero()).size(), 13);
  for (int k = 0; k < 13; ++k) {
    Eigen::Matrix<double, 13, 1> d = Eigen::Matrix<double, 13, 1>::Zero();
    d(k) = 1e-6;
    const Eigen::VectorXd up = measure(d);
    d(k) = -1e-6;
    J.col(k) = (up - measure(d)) / 2e-6;
  }
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::MatrixXd expected = H.topLeftCorner<7, 7>() - H.topRightCorner<7, 6>() *
                                                                 H.bottomRightCorner<6, 6>().inverse() *
                                                                 H.bottomLeftCorner<6, 7>();
  const PairInformation information = view_information(m, T_camera_board);
  EXPECT_LT((information - expected).norm(), 1e-4 * expected.norm());
}

TEST(ViewInformation, IsThreeDirectionsPerViewAndNothingWhereTheCameraSeesNothing) {
  const SightModel m = model();
  const PairInformation one = view_information(m, facing(0, 0, 1.5, {0.3, 0, 0}));
  Eigen::SelfAdjointEigenSolver<PairInformation> eigen(one);
  // A plane has two angles and a distance; its rays, not quite parallel, tell a bias from distance a little.
  EXPECT_GT(eigen.eigenvalues()(4), 1e-6 * eigen.eigenvalues()(6));
  EXPECT_LT(eigen.eigenvalues()(3), 1e-5 * eigen.eigenvalues()(6));
  EXPECT_TRUE(view_information(m, facing(0, 0, -1.5, {0, 0, 0})).isZero());
  EXPECT_TRUE(view_information(m, facing(2, 0, 1.5, {0, 0, 0})).isZero());
  SightModel blind = m;
  blind.lowest = 0.5;
  PairInformation none = view_information(blind, facing(0, 0, 1.5, {0.3, 0, 0}));
  EXPECT_LT(none.norm(), 1e-6 * one.norm());
}

/// Views as a person takes them who was told nothing: anywhere in sight, tilted a little.
std::vector<PairInformation> random_views(const SightModel& m, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<PairInformation> views;
  while (static_cast<int>(views.size()) < count) {
    const Eigen::Vector3d turn(0.6 * unit(random), 0.6 * unit(random), 0.3 * unit(random));
    const PairInformation view =
        view_information(m, facing(0.4 * unit(random), 0.3 * unit(random), 2 + unit(random), turn));
    if (!view.isZero()) views.push_back(view);
  }
  return views;
}

TEST(ChooseViews, FiveChosenAreFarBetterThanFiveAtRandom) {
  const SightModel m = model();
  std::mt19937_64 random(4);
  const SigmaTarget target;
  std::vector<double> ratios;
  for (int session = 0; session < 5; ++session) {
    const std::vector<PairInformation> views = random_views(m, 40, random);
    const auto sigma_of = [&](const std::vector<std::size_t>& indices) {
      PairInformation sum = bias_prior(0.02);
      for (const std::size_t i : indices) sum += views[i];
      return expected_sigma(sum, target);
    };
    const std::vector<std::size_t> chosen = choose_views(views, 5, bias_prior(0.02), target);
    ASSERT_EQ(chosen.size(), 5u);
    EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
    std::vector<double> others;
    std::vector<std::size_t> order(views.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (int k = 0; k < 201; ++k) {
      std::shuffle(order.begin(), order.end(), random);
      others.push_back(sigma_of({order.begin(), order.begin() + 5}).translation);
    }
    std::nth_element(others.begin(), others.begin() + 100, others.end());
    ratios.push_back(sigma_of(chosen).translation / others[100]);
    // And no single exchange makes them better.
    const double cost = sigma_of(chosen).cost;
    for (std::size_t k = 0; k < 5; ++k) {
      for (std::size_t i = 0; i < views.size(); ++i) {
        std::vector<std::size_t> other = chosen;
        if (std::find(other.begin(), other.end(), i) == other.end()) other[k] = i;
        EXPECT_GE(sigma_of(other).cost, cost * (1 - 1e-6));
      }
    }
  }
  std::sort(ratios.begin(), ratios.end());
  RecordProperty("median_ratio", std::to_string(ratios[2]));
  EXPECT_LE(ratios[2], 0.45);
}

TEST(ChooseViews, TakesAllOfFewAndNoneOfNothing) {
  const SightModel m = model();
  std::mt19937_64 random(5);
  const auto views = random_views(m, 3, random);
  EXPECT_EQ(choose_views(views, 5, bias_prior(0.02), {}), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(choose_views(views, 0, bias_prior(0.02), {}).empty());
  EXPECT_TRUE(choose_views({}, 4, bias_prior(0.02), {}).empty());
}

Rig rig_of(const SightModel& m) {
  Rig rig;
  rig.board = m.board;
  rig.cameras["left"].intrinsics = m.camera;
  rig.lidars["top"];
  return rig;
}

ViewSights sight(const SightModel& m, int id, const Pose& T_camera_board) {
  ViewSights view;
  view.id = id;
  view.cameras.resize(1);
  view.cameras[0].emplace();
  view.cameras[0]->pose.T_camera_board = T_camera_board;
  LidarSight lidar;
  lidar.center = m.T_camera_lidar.inverse() * T_camera_board.t;
  lidar.on_board.resize(1200);
  view.lidars.push_back({lidar});
  return view;
}

TEST(NextPose, FirstPosesDifferAndDetermineTheAnswer) {
  const SightModel m = model();
  const Rig rig = rig_of(m);
  PairInformation known = bias_prior(0.02);
  std::vector<ViewSights> views;
  for (int i = 0; i < 3; ++i) {
    const auto next = suggest_first_pose(rig, views);
    ASSERT_TRUE(next);
    EXPECT_EQ(next->camera, "left");
    const Eigen::Vector3d normal = next->T_camera_board.R.col(2);
    known += view_information(m, next->T_camera_board);
    for (const ViewSights& view : views) {
      EXPECT_GT(std::acos(normal.dot(view.cameras[0]->pose.T_camera_board.R.col(2))), 0.5);
    }
    views.push_back(sight(m, i + 1, next->T_camera_board));
  }
  EXPECT_LT(expected_sigma(known, {}).translation, 0.02);
  EXPECT_LT(expected_sigma(known, {}).rotation, 0.01);
  Rig blind = rig;
  blind.cameras["left"].intrinsics.reset();
  EXPECT_FALSE(suggest_first_pose(blind, views));
}

TEST(NextPose, FollowingTheAdviceBeatsRandomPoses) {
  const SightModel m = model();
  const Rig rig = rig_of(m);
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  const SigmaTarget target;
  std::vector<Pose> start;
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(-0.1, 0.3, 0), Eigen::Vector3d(0, -0.3, 0.2)}) {
    start.push_back(facing(0.1, 0, 1.6, turn));
  }
  const auto sigma_after = [&](bool advised) {
    std::vector<Pose> poses = start;
    PairInformation known = bias_prior(0.02);
    std::vector<ViewSights> views;
    Calibration calibration;
    calibration.cameras["left"].camera = m.camera;
    CalibratedTransform transform;
    transform.parent = "left";
    transform.child = "top";
    transform.T_parent_child = m.T_camera_lidar;
    for (std::size_t i = 0; i < 8; ++i) {
      if (i >= poses.size()) {
        if (advised) {
          transform.covariance = scaled_inverse(known)->topLeftCorner<6, 6>();
          calibration.transforms = {transform};
          const auto next = suggest_next_pose(rig, calibration, views, {}, target);
          EXPECT_TRUE(next);
          EXPECT_LT(next->sigma_translation, transform.sigma_translation());
          EXPECT_FALSE(next->words.empty());
          poses.push_back(next->T_camera_board);
        } else {
          for (;;) {
            const Pose pose = facing(0.4 * unit(random), 0.3 * unit(random), 2 + unit(random),
                                     {0.6 * unit(random), 0.6 * unit(random), 0});
            if (view_information(m, pose).isZero()) continue;
            poses.push_back(pose);
            break;
          }
        }
      }
      known += view_information(m, poses[i]);
      views.push_back(sight(m, static_cast<int>(i), poses[i]));
      calibration.views.push_back({static_cast<int>(i), true, "", 0, 0});
    }
    return expected_sigma(known, target).translation;
  };
  double at_random = 0;
  for (int k = 0; k < 10; ++k) at_random += sigma_after(false) / 10;
  EXPECT_LT(sigma_after(true), 0.7 * at_random);
}

TEST(NextPose, StaysWhereTheLidarLooks) {
  const SightModel m = model();
  const Rig rig = rig_of(m);
  Calibration calibration;
  calibration.cameras["left"].camera = m.camera;
  CalibratedTransform transform;
  transform.parent = "left";
  transform.child = "top";
  transform.T_parent_child = m.T_camera_lidar;
  transform.covariance.setIdentity();
  calibration.transforms = {transform};
  std::vector<ViewSights> views;
  for (int i = 0; i < 3; ++i) {
    views.push_back(sight(m, i, facing(0, 0.25, 1.5, {0.3 * i, 0.2, 0})));
    calibration.views.push_back({i, true, "", 0, 0});
  }
  const ElevationRange below{-0.4, -0.05};
  const auto next = suggest_next_pose(rig, calibration, views, {below}, {});
  ASSERT_TRUE(next);
  const Eigen::Vector3d p = m.T_camera_lidar.inverse() * next->T_camera_board.t;
  EXPECT_LT(std::asin(p.z() / p.norm()), 0.1);
  // A rig without such a pair has nothing to be advised on.
  calibration.transforms.clear();
  EXPECT_FALSE(suggest_next_pose(rig, calibration, views, {below}, {}));
}

TEST(PoseInWords, SaysWhatThePersonShouldDo) {
  EXPECT_EQ(pose_in_words({Eigen::Matrix3d::Identity(), {0, 0, 2}}),
            "in the middle, 2.0 m away, facing straight at the camera");
  // The board's face looks back along -z; turned about y (down) by +30 degrees it looks to the camera's left.
  EXPECT_EQ(pose_in_words({so3_exp({0, M_PI / 6, 0}), {0, 0, 1.5}}),
            "in the middle, 1.5 m away, facing 30 degrees left of the camera");
  EXPECT_EQ(pose_in_words({so3_exp({-M_PI / 6, 0, 0}), {0, 0, 1.5}}),
            "in the middle, 1.5 m away, facing 30 degrees above the camera");
  EXPECT_EQ(pose_in_words({so3_exp({0, 0, 0.2}), {-1, -1, 1.5}}).substr(0, 13), "left and high");
}

}  // namespace
}  // namespace ca2
