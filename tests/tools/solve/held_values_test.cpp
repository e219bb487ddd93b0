/// What is known exactly is believed when asked to, with covariances that are true then, and contradicted
/// where it is not known.
#include "core/solve/held_values.h"

#include <cmath>
#include <cstdio>

#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

constexpr HeldValues all_held{.intrinsics = true, .ranges = true};

struct Trials {
  int answers = 0, noted = 0, wrong_and_good = 0;
  double nees = 0, narrower = 0;
};

/// With given intrinsics off by `error`, six views each.
Trials run(const IntrinsicsError& error) {
  Trials sum;
  ScenarioFile file = load("paper", 6100);
  for (auto& [name, camera] : file.scenario.cameras) camera.noise.corner_sigma = refined_corner_sigma;
  for (auto& [name, lidar] : file.scenario.lidars) lidar.noise.range_bias = lidar.noise.reflectivity_bias = 0;
  std::mt19937_64 rng(19);
  for (int trial = 0; trial < 40; ++trial) {
    file.scenario.seed = rng();
    const std::vector<SimulatedView> views = pool_of(file.scenario, 6);
    const Rig rig = misstated_rig(rig_of(file.scenario), error, rng);
    const Result<std::vector<ViewSights>> sights = sights_of(rig, views);
    if (!sights) throw std::runtime_error(sights.error().text());
    const auto held = calibrate_holding(rig, *sights, {}, all_held);
    const auto free = calibrate(rig, *sights, {});
    if (!held || !free) continue;
    ++sum.answers;
    for (const auto& [name, camera] : held->cameras) EXPECT_FALSE(camera.estimated) << name;
    for (const auto& [name, lidar] : held->lidars) EXPECT_NEAR(lidar.range_bias, 0, 1e-9) << name;
    const double nees = worst_error(*held, file.scenario).nees / 6;
    const bool noted = held->notes.back().find("contradicts the views") != std::string::npos;
    sum.nees += nees;
    sum.noted += noted ? 1 : 0;
    sum.wrong_and_good += nees > 25 && held->observability.verdict == "good" ? 1 : 0;
    sum.narrower += held->transforms[0].sigma_translation() < free->transforms[0].sigma_translation();
  }
  std::printf(
      "held, off by %.1f px and %.1f %%: %d answers, NEES/6 %.2f, contradicted %d, wrong but good %d\n",
      error.pixel, 100 * error.focal, sum.answers, sum.nees / sum.answers, sum.noted, sum.wrong_and_good);
  return sum;
}

TEST(HeldValues, RightOnesGiveCovariancesThatAreTrue) {
  const Trials trials = run({});
  EXPECT_GE(trials.answers, 38);
  EXPECT_GT(trials.nees / trials.answers, 0.7);
  EXPECT_LT(trials.nees / trials.answers, 1.3);
  EXPECT_GE(trials.narrower, 0.9 * trials.answers);
  EXPECT_LE(trials.noted, 1);
}

TEST(HeldValues, WrongOnesAreContradicted) {
  const Trials trials = run({.pixel = 3, .focal = 0.01});
  EXPECT_GE(trials.noted, trials.answers / 2);
  EXPECT_EQ(trials.wrong_and_good, 0);
}

}  // namespace
}  // namespace ca2
