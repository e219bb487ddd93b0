/// Views that cannot determine the answer are refused with words, always, with and without noise; wrong
/// objects never make a wrong answer that is called good.
#include <Eigen/Geometry>
#include <cstdio>

#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

/// The rig of the paper, with or without noise.
Scenario paper(bool noise, std::uint64_t seed) {
  Scenario scenario = load("paper", seed).scenario;
  if (noise) return scenario;
  for (auto& [name, camera] : scenario.cameras) camera.noise.corner_sigma = 0;
  for (auto& [name, lidar] : scenario.lidars) {
    lidar.noise.range_sigma = lidar.noise.range_bias = lidar.noise.reflectivity_bias = 0;
    lidar.noise.dropout = 0;
  }
  return scenario;
}

/// The board at `place` in the camera's frame, its print turned by `yaw` and `pitch` [rad] from facing it.
Pose in_front(const Scenario& scenario, const Eigen::Vector3d& place, double yaw, double pitch, double roll) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  return scenario.T_rig_sensor("camera") * Pose{R, place};
}

/// A place anywhere in the picture; how the board is held is the caller's.
Eigen::Vector3d place(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double z = 3.2 + unit(rng);
  return {0.25 * z * unit(rng), 0.12 * z * unit(rng), z};
}

void expect_refused(const Rig& rig, const std::vector<SimulatedView>& views, const char* words,
                    std::initializer_list<Method> methods = {Method::joint, Method::plane_to_plane,
                                                             Method::kim}) {
  for (const Method method : methods) {
    const auto answer = calibrate_features(rig, views, method);
    ASSERT_FALSE(answer) << words;
    EXPECT_EQ(answer.error().code, ErrorCode::refused);
    for (const Problem& problem : answer.error().problems) {
      EXPECT_FALSE(problem.where.empty());
      EXPECT_NE(problem.what.find(words), std::string::npos) << problem.what;
      EXPECT_FALSE(problem.hint.empty());
    }
  }
}

TEST(Refusal, FewerThanThreeViewsWithoutRims) {
  for (const bool noise : {false, true}) {
    const Scenario scenario = paper(noise, 3001);
    const std::vector<SimulatedView> pool = pool_of(scenario, 2);
    const Rig rig = rig_of(scenario);
    Rig bare = rig;
    bare.board.outline.reset();
    for (const int count : {1, 2}) {
      const std::vector<SimulatedView> views(pool.begin(), pool.begin() + count);
      expect_refused(bare, views, "three are the least");
      expect_refused(rig, views, "three are the least", {Method::plane_to_plane, Method::kim});
    }
    const auto answer = calibrate_features(bare, {pool[0]});
    EXPECT_NE(answer.error().problems.front().hint.find("`outline`"), std::string::npos);
  }
}

TEST(Refusal, BoardsWithinHalfADegreeOfParallel) {
  for (const bool noise : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Scenario scenario = paper(noise, seed);
      std::mt19937_64 rng(seed);
      std::uniform_real_distribution<double> unit(-1, 1);
      const double half_degree = 0.5 * M_PI / 180;
      const double yaw = 0.6 * unit(rng), pitch = 0.4 * unit(rng);
      std::vector<SimulatedView> views;
      for (int v = 0; v < 10; ++v) {
        const Pose T_rig_board = in_front(scenario, place(rng), yaw + 0.7 * half_degree * unit(rng),
                                          pitch + 0.7 * half_degree * unit(rng), 0.5 * unit(rng));
        views.push_back(observe_features(scenario, T_rig_board, rng));
      }
      expect_refused(rig_of(scenario), views, "parallel");
    }
  }
}

TEST(Refusal, NormalsInOnePlane) {
  for (const bool noise : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Scenario scenario = paper(noise, seed);
      std::mt19937_64 rng(seed);
      std::uniform_real_distribution<double> unit(-1, 1);
      std::vector<SimulatedView> views;
      // Turned about the vertical only, or tipped about the horizontal only.
      for (int v = 0; v < 10; ++v) {
        const double turn = 0.8 * unit(rng);
        const Pose T_rig_board = in_front(scenario, place(rng), seed % 2 == 0 ? turn : 0,
                                          seed % 2 == 0 ? 0 : turn, 0.5 * unit(rng));
        views.push_back(observe_features(scenario, T_rig_board, rng));
      }
      expect_refused(rig_of(scenario), views, "one plane");
    }
  }
}

TEST(WrongObjects, NoWrongAnswerIsCalledGood) {
  int runs = 0, good = 0, refused = 0, beyond = 0, beyond_good = 0;
  int right = 0, right_used = 0, wrong = 0, wrong_used = 0;
  double worst_good = 0;
  for (const char* name : {"paper", "vlp16_blackfly", "os0_t265"}) {
    for (const WrongObject kind : {WrongObject::panel, WrongObject::moved}) {
      ScenarioFile file = load(name, 3100);
      file.scenario.wrong_fraction = 0.3;
      file.scenario.wrong_object = kind;
      const std::vector<SimulatedView> pool = pool_of(file.scenario, 100);
      const Rig rig = rig_of(file.scenario);
      std::mt19937_64 rng(13);
      for (int trial = 0; trial < 34; ++trial) {
        ++runs;
        const Rig stated = misstated_rig(rig, file.intrinsics_error, rng);
        const std::vector<SimulatedView> views = draw_subset(pool, trial % 2 == 0 ? 10 : 20, rng);
        const auto answer = calibrate_features(stated, views);
        if (!answer) {
          ++refused;
          continue;
        }
        const bool is_good = answer->observability.verdict == "good";
        const double sigmas = std::sqrt(worst_error(*answer, file.scenario).nees / 6);
        good += is_good ? 1 : 0;
        beyond += sigmas > 5 ? 1 : 0;
        beyond_good += is_good && sigmas > 5 ? 1 : 0;
        if (is_good) worst_good = std::max(worst_good, sigmas);
        for (std::size_t v = 0; v < views.size(); ++v) {
          const bool lies = views[v].wrong_object != WrongObject::none;
          // Two cameras need no LiDAR to make a view useful.
          if (lies && rig.cameras.size() > 1) continue;
          (lies ? wrong : right) += 1;
          (lies ? wrong_used : right_used) += answer->views[v].used ? 1 : 0;
          EXPECT_EQ(answer->views[v].used, answer->views[v].reason.empty());
        }
      }
    }
  }
  std::printf(
      "30 %% wrong: %d runs, %d good, %d refused, %d beyond 5 sigma (%d of them good; worst good %.1f); "
      "right views used %d of %d, wrong ones %d of %d\n",
      runs, good, refused, beyond, beyond_good, worst_good, right_used, right, wrong_used, wrong);
  EXPECT_GE(runs, 200);
  EXPECT_EQ(beyond_good, 0);
  EXPECT_GE(right_used, right * 95 / 100);
  EXPECT_LE(wrong_used, wrong / 50);
  EXPECT_GE(good, runs / 2);
}

TEST(WrongObjects, OneMakesGivenValuesLessBelieved) {
  ScenarioFile file = load("paper", 3200);
  std::vector<SimulatedView> views = pool_of(file.scenario, 12);
  const Rig rig = rig_of(file.scenario);
  const auto alone = calibrate_features(rig, views);
  file.scenario.wrong_fraction = 1;
  views.push_back(pool_of(file.scenario, 1).front());
  const auto with = calibrate_features(rig, views);
  ASSERT_TRUE(alone && with);
  ASSERT_FALSE(with->views.back().used);
  const CalibratedTransform &without_it = alone->transforms.front(), &with_it = with->transforms.front();
  EXPECT_LT((with_it.T_parent_child.t - without_it.T_parent_child.t).norm(), 1e-4);
  EXPECT_GT(with_it.covariance.trace(), 1.05 * without_it.covariance.trace());
}

}  // namespace
}  // namespace ca2
