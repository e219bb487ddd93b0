#include "tools/sim/feature_simulator.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "core/geometry/plane.h"
#include "tests/tools/sim/test_rigs.h"
#include "tools/sim/placement.h"
#include "tools/sim/plate.h"
#include "tools/sim/range_model.h"

namespace ca2 {
namespace {

Scenario without_noise(Scenario scenario) {
  for (auto& [name, camera] : scenario.cameras) camera.noise.corner_sigma = 0;
  for (auto& [name, lidar] : scenario.lidars) {
    lidar.noise.range_sigma = 0;
    lidar.noise.dropout = 0;
    lidar.beams.range_quantum = 0;
  }
  return scenario;
}

TEST(Plate, RaysMeetTheBentSurface) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Plate plate{{0.4, 0.3, {0.01, -0.02}}, 0.006};
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d origin(uniform(rng), uniform(rng), -2 + uniform(rng));
    const Eigen::Vector3d target(0.3 * uniform(rng), 0.2 * uniform(rng), 0);
    const Eigen::Vector3d direction = (target - origin).normalized();
    const auto t = plate.intersect(origin, direction);
    if (!t) {
      // Only a ray towards the rim or beyond may miss.
      EXPECT_FALSE(plate.contains(target.head<2>(), 0.02));
      continue;
    }
    ++hits;
    const Eigen::Vector3d p = origin + *t * direction;
    EXPECT_NEAR(p.z(), plate.height(p.head<2>()), 1e-12);
    EXPECT_TRUE(plate.contains(p.head<2>()));
  }
  EXPECT_GT(hits, 500);
}

TEST(FeatureSimulator, NoiseFreeReturnsLieOnTheBoardAndCornersOnItsImage) {
  Scenario scenario = without_noise(small_scenario());
  scenario.views = 30;
  const auto views = simulate_feature_views(scenario);
  ASSERT_TRUE(views) << views.error().text();
  const std::vector<Eigen::Vector2d> corners = scenario.board.type->corners(scenario.board);
  for (const SimulatedView& view : *views) {
    const Plane plane = board_plane(view.T_sensor_board.at("top"));
    const Scan& scan = view.board_returns.at("top");
    const std::vector<BeamRay>& rays = view.rays.at("top");
    ASSERT_EQ(rays.size(), scan.size());
    EXPECT_GE(static_cast<int>(scan.size()), scenario.placement.min_returns / 2);
    for (std::size_t i = 0; i < scan.size(); ++i) {
      EXPECT_NEAR(plane.distance(scan.points[i].cast<double>()), 0, 1e-6);
      EXPECT_LT((scan.points[i].cast<double>() - rays[i].origin).cross(rays[i].direction).norm(), 1e-6);
    }
    const auto& [camera, T_rig_camera, noise] = scenario.cameras.at("front");
    ASSERT_EQ(view.corners.at("front").size(), corners.size());
    for (const Corner& corner : view.corners.at("front")) {
      const Eigen::Vector2d& p = corners[static_cast<std::size_t>(corner.id)];
      const auto pixel = camera.project(view.T_sensor_board.at("front") * Eigen::Vector3d(p.x(), p.y(), 0));
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - corner.pixel).norm(), 1e-9);
    }
    // One board, seen by both: the two truths differ by the extrinsic.
    const Pose T_camera_lidar = T_rig_camera.inverse() * scenario.lidars.at("top").T_rig_lidar;
    const Pose loop =
        view.T_sensor_board.at("front").inverse() * T_camera_lidar * view.T_sensor_board.at("top");
    EXPECT_LT(Pose{}.difference(loop).norm(), 1e-12);
  }
}

TEST(FeatureSimulator, NoiseIsWhatTheScenarioSays) {
  Scenario scenario = small_scenario();
  LidarNoise& noise = scenario.lidars.at("top").noise;
  noise.range_sigma = 0.012;
  noise.range_bias = 0.02;
  noise.reflectivity_bias = 0.01;
  noise.dropout = 0.1;
  scenario.views = 60;
  const auto views = simulate_feature_views(scenario);
  ASSERT_TRUE(views) << views.error().text();
  double corner_square = 0, white_sum = 0, white_square = 0, black_sum = 0;
  int corner_count = 0, white = 0, black = 0;
  const std::vector<Eigen::Vector2d> corners = scenario.board.type->corners(scenario.board);
  for (const SimulatedView& view : *views) {
    for (const Corner& corner : view.corners.at("front")) {
      const Eigen::Vector2d& p = corners[static_cast<std::size_t>(corner.id)];
      const auto pixel = scenario.cameras.at("front").camera.project(view.T_sensor_board.at("front") *
                                                                     Eigen::Vector3d(p.x(), p.y(), 0));
      corner_square += (*pixel - corner.pixel).squaredNorm();
      corner_count += 2;
    }
    const Pose T_board_lidar = view.T_sensor_board.at("top").inverse();
    const Plate plate{scenario.board.extent(), 0};
    for (std::size_t i = 0; i < view.rays.at("top").size(); ++i) {
      const BeamRay& ray = view.rays.at("top")[i];
      const Eigen::Vector3d origin = T_board_lidar * ray.origin;
      const Eigen::Vector3d direction = T_board_lidar.R * ray.direction;
      const auto truth = plate.intersect(origin, direction);
      ASSERT_TRUE(truth);
      const double error = static_cast<double>(view.board_returns.at("top").range[i]) - *truth;
      if (scenario.board.type->black(scenario.board, (origin + *truth * direction).head<2>())) {
        black_sum += error;
        ++black;
      } else {
        white_sum += error;
        white_square += (error - noise.range_bias) * (error - noise.range_bias);
        ++white;
      }
    }
  }
  ASSERT_GT(black, 500);
  ASSERT_GT(white, 500);
  EXPECT_NEAR(std::sqrt(corner_square / corner_count), 0.05, 0.002);
  EXPECT_NEAR(white_sum / white, 0.02, 4 * 0.012 / std::sqrt(white));
  EXPECT_NEAR(std::sqrt(white_square / white), 0.012, 0.001);
  // Toner reflects a tenth of what paper does: nine tenths of the bias.
  EXPECT_NEAR(black_sum / black, 0.02 + 0.01 * (1 - ink_reflectivity / paper_reflectivity),
              4 * 0.012 / std::sqrt(black));
}

TEST(FeatureSimulator, SameSeedSameViewsAndMoreViewsExtend) {
  Scenario scenario = small_scenario();
  scenario.views = 5;
  const auto few = simulate_feature_views(scenario);
  scenario.views = 8;
  const auto more = simulate_feature_views(scenario);
  scenario.seed = 2;
  const auto other = simulate_feature_views(scenario);
  ASSERT_TRUE(few && more && other);
  for (std::size_t i = 0; i < few->size(); ++i) {
    ASSERT_EQ((*few)[i].board_returns.at("top").points, (*more)[i].board_returns.at("top").points);
    ASSERT_EQ((*few)[i].corners.at("front")[7].pixel, (*more)[i].corners.at("front")[7].pixel);
    EXPECT_NE((*few)[i].corners.at("front")[7].pixel, (*other)[i].corners.at("front")[7].pixel);
  }
}

TEST(FeatureSimulator, WrongViewsComeInTheirShareAndLieElsewhere) {
  Scenario scenario = without_noise(small_scenario());
  scenario.wrong_fraction = 0.3;
  scenario.views = 200;
  const auto views = simulate_feature_views(scenario);
  ASSERT_TRUE(views) << views.error().text();
  int wrong = 0;
  for (const SimulatedView& view : *views) {
    const Plane plane = board_plane(view.T_sensor_board.at("top"));
    double worst = 0;
    for (const Eigen::Vector3f& p : view.board_returns.at("top").points) {
      worst = std::max(worst, std::abs(plane.distance(p.cast<double>())));
    }
    if (view.wrong_object == WrongObject::none) {
      EXPECT_LT(worst, 1e-6);
    } else {
      ++wrong;
      EXPECT_GT(worst, 0.01);
    }
  }
  EXPECT_NEAR(wrong, 60, 4 * std::sqrt(200 * 0.3 * 0.7));
}

TEST(FeatureSimulator, ChangedFrameKeepsTheBoard) {
  const Scenario scenario = without_noise(small_scenario());
  std::mt19937_64 rng(5);
  auto view = simulate_features(scenario, rng);
  ASSERT_TRUE(view) << view.error().text();
  change_lidar_frame(*view, "top", Pose{so3_exp({1, -2, 0.5}), {0.3, 0.1, -0.2}});
  const Plane plane = board_plane(view->T_sensor_board.at("top"));
  for (std::size_t i = 0; i < view->rays.at("top").size(); ++i) {
    const Eigen::Vector3d p = view->board_returns.at("top").points[i].cast<double>();
    const BeamRay& ray = view->rays.at("top")[i];
    EXPECT_NEAR(plane.distance(p), 0, 1e-6);
    EXPECT_LT((p - ray.origin).cross(ray.direction).norm(), 1e-6);
  }
}

TEST(FeatureSimulator, ImpossibleSharedFieldOfViewIsAnError) {
  Scenario scenario = small_scenario();
  // The camera looks up at the ceiling, over every beam.
  scenario.cameras.at("front").T_rig_camera.R = so3_exp({0, -1.57, 0}) * optical_axes();
  const auto views = simulate_feature_views(scenario);
  ASSERT_FALSE(views);
  EXPECT_EQ(views.error().code, ErrorCode::config);
}

TEST(FeatureSimulator, TakesMillisecondsPerView) {
  Scenario scenario = small_scenario();
  scenario.lidars.at("top").beams = make_beam_table({"HDL-64E-nominal", {}, {}, 10, 0}).value();
  scenario.views = 100;
  const auto start = std::chrono::steady_clock::now();
  const auto views = simulate_feature_views(scenario);
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
  ASSERT_TRUE(views) << views.error().text();
  std::printf("simulate_features, HDL-64E: %.2f ms per view\n", elapsed.count() / scenario.views);
  EXPECT_LT(elapsed.count() / scenario.views, 100);
}

}  // namespace
}  // namespace ca2
