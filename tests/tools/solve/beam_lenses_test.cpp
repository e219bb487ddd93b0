/// Beams that begin in a lens which their points leave out: told from beams of the axis by the planes, and
/// where these are too few to tell, the covariance has both.
#include "core/solve/beam_lenses.h"

#include <cstdio>
#include <stop_token>
#include <utility>

#include "core/lidar/beam_lens.h"
#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

constexpr int trials = 20;
constexpr const char* beyond_doubt = "it was taken into account";
constexpr const char* doubtful = "these views do not tell whether the beams";

/// The LiDAR with beams that begin in the lens.
Scenario with_lens(Scenario scenario) {
  for (BeamRay& ray : scenario.lidars.at("puck").beams.rays) {
    ray.origin.z() -= beam_lens_radius("VLP-16") * ray.direction.z() / ray.direction.head<2>().norm();
  }
  return scenario;
}

/// The points of these returns as a driver makes them that takes beams of the lens for beams of the axis.
std::vector<ViewSights> leaving_lens_out(std::vector<ViewSights> views) {
  for (ViewSights& view : views) {
    for (LidarSight& sight : view.lidars[0]) {
      for (auto* returns : {&sight.on_board, &sight.around}) {
        for (BoardReturn& one : *returns) one.point.z() -= std::exchange(one.height, 0.0f);
      }
    }
  }
  return views;
}

struct Tally {
  int answers = 0, taken = 0, doubts = 0;
  double nees = 0;          // per degree of freedom
  double translation2 = 0;  // m^2

  void add(const Calibration& answer, const Scenario& scenario) {
    const CalibratedTransform& first = answer.transforms.front();
    const TransformError error = error_of(first, true_transform(scenario, first.parent, first.child));
    ++answers;
    nees += error.nees / 6;
    translation2 += error.translation * error.translation;
    for (const std::string& note : answer.notes) {
      taken += note.find(beyond_doubt) != std::string::npos ? 1 : 0;
      doubts += note.find(doubtful) != std::string::npos ? 1 : 0;
    }
  }
  double mean_nees() const { return nees / answers; }
};

class BeamLenses : public testing::Test {
 protected:
  ScenarioFile file = load("vlp16_blackfly_a3", 5001);

  void SetUp() override {
    for (auto& [name, camera] : file.scenario.cameras) camera.noise.corner_sigma = refined_corner_sigma;
  }

  /// Without the plate's outline: planes alone.
  Tally run(int views, bool left_out, const char* model = "VLP-16") const {
    Rig rig = rig_of(file.scenario);
    rig.board.outline.reset();
    rig.lidars.at("puck").model = model;
    rig.lidars.at("puck").metadata.clear();
    const std::vector<SimulatedView> pool = pool_of(left_out ? with_lens(file.scenario) : file.scenario, 60);
    std::mt19937_64 rng(12);
    Tally tally;
    for (int trial = 0; trial < trials; ++trial) {
      const auto sights = sights_of(rig, draw_subset(pool, views, rng));
      if (!sights) continue;
      const auto answer = calibrate(rig, left_out ? leaving_lens_out(*sights) : *sights, {});
      if (answer) tally.add(*answer, file.scenario);
    }
    std::printf("%d views, lens %s: %d answers, taken in %d, doubtful in %d; %.2f mm rms, NEES/6 %.2f\n",
                views, left_out ? "left out" : "not there", tally.answers, tally.taken, tally.doubts,
                1e3 * std::sqrt(tally.translation2 / tally.answers), tally.mean_nees());
    return tally;
  }
};

TEST_F(BeamLenses, TenViewsTellOneThatWasLeftOut) {
  const Tally found = run(10, true);
  EXPECT_EQ(found.answers, trials);
  EXPECT_EQ(found.taken, trials);
  EXPECT_LT(found.mean_nees(), 1.5);
}

TEST_F(BeamLenses, TenViewsTellThatThereIsNone) {
  const Tally found = run(10, false);
  EXPECT_EQ(found.answers, trials);
  EXPECT_EQ(found.taken, 0);
  EXPECT_EQ(found.doubts, 0);
  EXPECT_LT(found.mean_nees(), 1.5);
}

TEST_F(BeamLenses, ALidarWithoutANameIsAskedToo) {
  const Tally left_out = run(10, true, ""), without = run(10, false, "");
  EXPECT_EQ(left_out.taken, trials);
  EXPECT_LT(left_out.mean_nees(), 1.5);
  EXPECT_EQ(without.taken, 0);
  EXPECT_EQ(without.doubts, 0);
}

TEST_F(BeamLenses, AnotherModelsNameIsBelieved) {
  const Tally found = run(10, true, "Puck-Hi-Res");
  EXPECT_EQ(found.taken, 0);
  EXPECT_EQ(found.doubts, 0);
}

TEST_F(BeamLenses, ThreeViewsDoNotAndTheCovarianceHasBoth) {
  const Tally without = run(3, false), left_out = run(3, true);
  EXPECT_GT(without.doubts + left_out.doubts, trials / 2);
  EXPECT_LT(without.mean_nees(), 1.5);
  EXPECT_LT(left_out.mean_nees(), 1.5);
}

TEST(BeamLens, PointsMoveToWhereBeamsThroughTheLensHaveThem) {
  ViewSights view;
  view.lidars.resize(1);
  LidarSight& sight = view.lidars[0].emplace_back();
  sight.on_board.push_back({{3, 4, 2.5}});
  sight.crossings.push_back({{0.6f, 0, 0.8f}, {0, 0.8f, -0.6f}});
  EXPECT_TRUE(leaves_lens_out({view}, 0, 0.04));
  const std::vector<ViewSights> moved = through_lens({view}, 0, 0.04);
  EXPECT_FALSE(leaves_lens_out(moved, 0, 0.04));
  const LidarSight& now = moved[0].lidars[0][0];
  EXPECT_FLOAT_EQ(now.on_board[0].height, -0.02f);
  EXPECT_FLOAT_EQ(now.on_board[0].point.z(), 2.48f);
  EXPECT_FLOAT_EQ(now.crossings[0].inside_height, -0.04f * 0.8f / 0.6f);
  EXPECT_FLOAT_EQ(now.crossings[0].outside_height, 0.04f * 0.6f / 0.8f);
}

TEST(BeamLens, OnlyViewsThatBothUseAreCompared) {
  const std::vector<Misfit> poor{{20, 0, 6, 0}, {}, {100, 0, 3, 0}}, good{{4, 0, 6, 0}, {90, 0, 3, 0}, {}};
  EXPECT_DOUBLE_EQ(planes_gain(poor, good), 8);
  EXPECT_DOUBLE_EQ(planes_gain(good, poor), -8);
  EXPECT_EQ(planes_gain({}, {}), 0);
}

TEST(BeamLens, WhatNeitherExplainsSaysLittle) {
  EXPECT_DOUBLE_EQ(planes_gain({{72, 0, 6, 0}}, {{24, 0, 6, 0}}), 6);
}

/// The daemon stops a solve as soon as there is another view, wherever it is.
TEST_F(BeamLenses, AnAnswerThatWasStoppedIsNotRead) {
  Rig rig = rig_of(file.scenario);
  rig.board.outline.reset();
  rig.lidars.at("puck").model = "VLP-16";
  std::mt19937_64 rng(12);
  const auto sights = sights_of(rig, draw_subset(pool_of(with_lens(file.scenario), 60), 4, rng));
  ASSERT_TRUE(sights);
  const std::vector<ViewSights> views = leaving_lens_out(*sights);
  const auto seed = seed_rig(rig.board, views, {"blackfly"}, {"puck"}, {});
  ASSERT_TRUE(seed) << seed.error().text();
  std::stop_source source;
  source.request_stop();
  JointOptions options;
  options.stop = source.get_token();
  const LensedAnswer stopped =
      solve_with_lenses(rig, {*rig.cameras.begin()->second.intrinsics}, views, *seed, options);
  EXPECT_FALSE(stopped.lenses[0].taken);
}

}  // namespace
}  // namespace ca2
