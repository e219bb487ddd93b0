/// Over 240 holds on four rigs: every one captured in time, nothing while the board moves, nothing twice.
/// Features are simulated (feature_host.h), so this is about the pipeline, not about the detectors.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/left_out.h"
#include "tests/tools/capture/feature_host.h"
#include "tools/sim/scenario_file.h"

namespace ca2 {
namespace {

using test::FeatureHost;
using test::FeatureHostOptions;
using test::StoredView;

struct Tally {
  int holds = 0, captured = 0, twice = 0, moving = 0;
  double longest = 0;   ///< s from the board's standstill to the request to store
  double farthest = 0;  ///< m: mean distance of a view's board from where it is held, of the worst view
};

Tally count(const PersonMotion& motion, const FeatureHost& host, double clock_offset) {
  Tally tally;
  // Motion of least jerk ends slowly: in its last fifth of a second the board comes closer by millimetres.
  constexpr double settling = 0.2;  // s
  std::vector<int> captures(motion.holds().size(), 0);
  for (const StoredView& view : host.stored) {
    bool inside = false;
    for (std::size_t i = 0; i < motion.holds().size(); ++i) {
      const TrueHold& hold = motion.holds()[i];
      if (view.first - clock_offset < hold.from - settling || view.last - clock_offset > hold.to + settling)
        continue;
      inside = true;
      ++captures[i];
      tally.longest = std::max(tally.longest, view.time - hold.from);
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      constexpr int samples = 20;
      for (int k = 0; k <= samples; ++k) {
        const double time = view.first + (view.last - view.first) * k / samples - clock_offset;
        mean += (motion.at(time).t - hold.T_rig_board.t) / (samples + 1);
      }
      tally.farthest = std::max(tally.farthest, mean.norm());
    }
    tally.moving += inside ? 0 : 1;
  }
  for (std::size_t i = 0; i < captures.size(); ++i) {
    ++tally.holds;
    tally.captured += captures[i] > 0;
    tally.twice += captures[i] > 1;
    if (captures[i] > 0) continue;
    const TrueHold& hold = motion.holds()[i];
    std::printf("hold %d, %.2f s long, was missed\n", hold.id, hold.to - hold.from);
    for (const CaptureEvent& event : host.events) {
      const double time = FeatureHost::seconds(event.time);
      if (time > hold.from && time < hold.to + 0.3)
        std::printf("  %.2f s: %s %s\n", time - hold.from, event.kind.c_str(), event.text.c_str());
    }
  }
  return tally;
}

class Holds : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (test::left_out(GetParam())) GTEST_SKIP() << "built without this rig's board";
  }

  static Scenario scenario(int views) {
    const auto file =
        std::filesystem::path(CA2_SOURCE_DIR) / "config/scenarios" / (std::string(GetParam()) + ".yaml");
    Scenario scenario = read_scenario(file).value().scenario;
    scenario.views = views;
    return scenario;
  }
};

TEST_P(Holds, AreAllCapturedOnceAndInTime) {
  Tally all;
  // 60 holds, no two alike, in sessions of 20.
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Scenario rig = scenario(20);
    rig.seed = seed;
    const auto motion = PersonMotion::plan(rig);
    ASSERT_TRUE(motion) << motion.error().text();
    FeatureHost host(rig, *motion, {});
    host.run();
    const Tally tally = count(*motion, host, 0);
    all.holds += tally.holds;
    all.captured += tally.captured;
    all.twice += tally.twice;
    all.moving += tally.moving;
    all.longest = std::max(all.longest, tally.longest);
    all.farthest = std::max(all.farthest, tally.farthest);
  }
  RecordProperty("captured", all.captured);
  std::printf("%s: %d of %d holds captured, %d twice, %d while moving, %.2f s at most, %.1f mm off\n",
              GetParam(), all.captured, all.holds, all.twice, all.moving, all.longest, 1e3 * all.farthest);
  EXPECT_EQ(all.holds, 60);
  EXPECT_EQ(all.captured, all.holds);
  EXPECT_EQ(all.twice, 0);
  EXPECT_EQ(all.moving, 0);
  EXPECT_LT(all.longest, 1.0);
  EXPECT_LT(all.farthest, 0.003);  // hands drift by that
}

TEST_P(Holds, AreCapturedInSpiteOfClocksAndLosses) {
  Scenario rig = scenario(12);
  const auto motion = PersonMotion::plan(rig);
  ASSERT_TRUE(motion) << motion.error().text();
  FeatureHostOptions options;
  options.clock_offset = 0.008;
  options.lost = 0.05;
  FeatureHost host(rig, *motion, options);
  host.run();
  const Tally tally = count(*motion, host, options.clock_offset);
  EXPECT_GE(tally.captured, 11);
  EXPECT_EQ(tally.twice, 0);
  EXPECT_EQ(tally.moving, 0);
}

TEST_P(Holds, AreNotViewsWhereOnlyTheHolderIsSeen) {
  Scenario rig = scenario(16);
  const auto motion = PersonMotion::plan(rig);
  ASSERT_TRUE(motion) << motion.error().text();
  FeatureHostOptions options;
  // After the first solves the extrinsics are known.
  options.blind_holds = {9, 11, 14};
  FeatureHost host(rig, *motion, options);
  host.run();
  for (const int id : options.blind_holds) {
    const TrueHold& hold = motion->holds()[static_cast<std::size_t>(id) - 1];
    for (const StoredView& view : host.stored)
      EXPECT_FALSE(view.last > hold.from && view.first < hold.to) << "hold " << id;
  }
  EXPECT_EQ(host.stored.size(), motion->holds().size() - options.blind_holds.size());
}

INSTANTIATE_TEST_SUITE_P(Rigs, Holds, testing::Values("paper", "os0_t265", "os0_manta", "vlp16_blackfly_a3"));

}  // namespace
}  // namespace ca2
