/// No initial guess: any relative rotation of the sensors, the same answer for the same input, and for corner
/// ids that start at the other end of the board.
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "core/solve/half_turn.h"
#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

Pose random_rotation(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const double w = normal(rng), x = normal(rng), y = normal(rng), z = normal(rng);
  return Pose::from_quaternion(Eigen::Quaterniond(w, x, y, z), Eigen::Vector3d::Zero());
}

TEST(Convergence, AThousandRelativeRotations) {
  const ScenarioFile file = load("paper", 2002);
  const std::vector<SimulatedView> pool = pool_of(file.scenario, 60);
  const Rig rig = rig_of(file.scenario);
  const Pose T_camera_lidar = true_transform(file.scenario, "camera", "velodyne");
  std::mt19937_64 rng(11);
  int answers = 0;
  double worst_rotation = 0, worst_nees = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    // The rays start at the sensor's origin: the LiDAR can be turned about it, not moved.
    const Pose T_turned_lidar = random_rotation(rng);
    std::vector<SimulatedView> views = draw_subset(pool, 6, rng);
    for (SimulatedView& view : views) change_lidar_frame(view, "velodyne", T_turned_lidar);
    const auto answer = calibrate_features(rig, views);
    if (!answer) continue;
    ++answers;
    const TransformError error = error_of(answer->transforms[0], T_camera_lidar * T_turned_lidar.inverse());
    worst_rotation = std::max(worst_rotation, error.rotation);
    worst_nees = std::max(worst_nees, error.nees);
  }
  std::printf("1000 rotations: %d answers, worst %.2f mrad, worst NEES/6 %.2f\n", answers,
              1e3 * worst_rotation, worst_nees / 6);
  EXPECT_EQ(answers, 1000);
  EXPECT_LT(worst_rotation, 0.02);
  EXPECT_LT(worst_nees / 6, 25.0 / 3);  // 7 sigma
}

TEST(Convergence, SameInputSameBits) {
  for (const char* name : {"os0_t265", "vlp16_blackfly"}) {
    const ScenarioFile file = load(name, 2003);
    const std::vector<SimulatedView> views = pool_of(file.scenario, 8);
    const auto once = calibrate_features(rig_of(file.scenario), views);
    const auto again = calibrate_features(rig_of(file.scenario), views);
    ASSERT_TRUE(once && again);
    EXPECT_EQ(to_yaml(*once), to_yaml(*again));
    for (std::size_t i = 0; i < once->transforms.size(); ++i) {
      EXPECT_EQ(once->transforms[i].covariance, again->transforms[i].covariance);
      EXPECT_EQ(once->transforms[i].T_parent_child.R, again->transforms[i].T_parent_child.R);
    }
  }
}

TEST(Convergence, OneCameraCountsTheCornersFromTheOtherEnd) {
  const ScenarioFile file = load("os0_t265", 2004);
  ASSERT_TRUE(file.scenario.board.type->half_turn_ambiguous(file.scenario.board));
  const int corners = static_cast<int>(file.scenario.board.type->corners(file.scenario.board).size());
  const Rig rig = rig_of(file.scenario);
  std::vector<SimulatedView> views = pool_of(file.scenario, 10);
  const auto plain = calibrate_features(rig, views);
  for (std::size_t v = 0; v < views.size(); v += 3) turn_ids(views[v].corners.at("right"), corners);
  turn_ids(views[4].corners.at("left"), corners);
  const auto turned = calibrate_features(rig, views);
  ASSERT_TRUE(plain && turned);
  for (std::size_t i = 0; i < plain->transforms.size(); ++i) {
    const Vector6d d = plain->transforms[i].T_parent_child.difference(turned->transforms[i].T_parent_child);
    EXPECT_LT(d.norm(), 1e-6) << plain->transforms[i].parent << " " << plain->transforms[i].child;
  }
  for (const CalibratedView& view : turned->views) EXPECT_TRUE(view.used) << view.reason;
}

/// What holds the plate: returns from beside its left rim, 15 mm behind it, from near to where a ray went.
void hold_by_left_rim(const Outline& plate, const Pose& T_lidar_board, LidarSight& sight) {
  const Eigen::Vector2d left = plate.center - Eigen::Vector2d(plate.width / 2, 0);
  for (double x = -0.10; x < 0; x += 0.01) {
    for (double y = -0.05; y < 0.05; y += 0.01) {
      const Eigen::Vector3d p = T_lidar_board * Eigen::Vector3d(left.x() + x, left.y() + y, 0.015);
      sight.around.push_back(
          {p.cast<float>(), BoardReturn::no_ring, BoardReturn::no_intensity, sight.on_board[0].height});
    }
  }
}

/// The rims tell which way round the plate is; until then nothing beside it may be taken for it.
TEST(Convergence, APlateOffItsPatternIsFoundEitherWayRound) {
  ScenarioFile file = load("os0_t265", 2005);
  const Outline plate{0.56, 0.42, {0.08, 0.05}};
  file.scenario.board.outline = plate;
  ASSERT_TRUE(file.scenario.board.type->half_turn_ambiguous(file.scenario.board));
  const int corners = static_cast<int>(file.scenario.board.type->corners(file.scenario.board).size());
  const Rig rig = rig_of(file.scenario);
  std::vector<SimulatedView> views = pool_of(file.scenario, 10);
  for (std::size_t v = 0; v < views.size(); v += 2) {
    for (auto& [name, seen] : views[v].corners) turn_ids(seen, corners);
  }
  auto sights = sights_of(rig, views);
  ASSERT_TRUE(sights);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Pose& T_lidar_board = views[v].T_sensor_board.at(rig.lidars.begin()->first);
    for (LidarSight& sight : (*sights)[v].lidars[0]) hold_by_left_rim(plate, T_lidar_board, sight);
  }
  const auto answer = calibrate(rig, *sights, {});
  ASSERT_TRUE(answer);
  for (const CalibratedView& view : answer->views) EXPECT_TRUE(view.used) << view.reason;
  EXPECT_EQ(answer->notes, std::vector<std::string>{});
  EXPECT_LT(worst_error(*answer, file.scenario).nees / 6, 2.5);
}

/// What only the cameras disagree about says nothing against the LiDAR.
/// On the mean of some pools: what a shake of 0.01 px does to one of them is a matter of chance.
TEST(Convergence, CamerasThatDisagreeWidenTheirOwnShareOnly) {
  ScenarioFile file = load("os0_t265", 2006);
  for (auto& [name, camera] : file.scenario.cameras) camera.noise.corner_sigma = refined_corner_sigma;
  std::mt19937_64 rng(13);
  std::normal_distribution<double> shift(0, 0.01);  // px, of a whole picture
  double widening = 0;
  constexpr int pools = 6;
  for (int pool = 0; pool < pools; ++pool, ++file.scenario.seed) {
    std::vector<SimulatedView> views = pool_of(file.scenario, 15);
    const auto plain = calibrate_features(rig_of(file.scenario), views);
    for (SimulatedView& view : views) {
      const Eigen::Vector2d by(shift(rng), shift(rng));
      for (Corner& corner : view.corners.at("right")) corner.pixel += by;
    }
    const auto shaken = calibrate_features(rig_of(file.scenario), views);
    ASSERT_TRUE(plain && shaken);
    EXPECT_TRUE(std::any_of(shaken->notes.begin(), shaken->notes.end(), [](const std::string& note) {
      return note.find("the cameras disagree") != std::string::npos;
    }));
    const auto variance = [](const Calibration& answer) { return answer.transforms[0].covariance.trace(); };
    widening += variance(*shaken) / variance(*plain) / pools;
  }
  EXPECT_LT(widening, 1.4);
}

}  // namespace
}  // namespace ca2
