/// Beams that are wide where they leave the LiDAR see every plate too large by the same millimetres at any
/// distance: few views must not be sure that there is nothing of it, fifteen tell it.
#include <algorithm>
#include <cstdio>

#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

struct Tally {
  int answers = 0, noted = 0;
  double nees = 0, worst = 0;  // per degree of freedom: mean; the largest
  double translation = 0;      // m, mean
};

Tally calibrations(const char* scenario, double beam_width, int views, int trials) {
  ScenarioFile file = load(scenario, 6200);
  for (auto& [name, lidar] : file.scenario.lidars) lidar.noise.beam_width = beam_width;
  for (auto& [name, camera] : file.scenario.cameras) camera.noise.corner_sigma = refined_corner_sigma;
  Tally tally;
  for (int trial = 0; trial < trials; ++trial) {
    ++file.scenario.seed;
    const auto answer = calibrate_features(rig_of(file.scenario), pool_of(file.scenario, views));
    if (!answer) continue;  // three views may not determine it
    const CalibratedTransform& first = answer->transforms.front();
    const TransformError error = error_of(first, true_transform(file.scenario, first.parent, first.child));
    ++tally.answers;
    tally.nees += error.nees / 6;
    tally.worst = std::max(tally.worst, error.nees / 6);
    tally.translation += error.translation;
    tally.noted += static_cast<int>(std::ranges::count_if(
        answer->notes, [](const std::string& note) { return note.find("rims lie") != std::string::npos; }));
  }
  tally.nees /= tally.answers;
  tally.translation /= tally.answers;
  std::printf("%-18s %2.0f mm, %2d views: %2d answers, mean %.2f mm, NEES/6 %.2f, worst %.1f, noted %d\n",
              scenario, 1e3 * beam_width, views, tally.answers, 1e3 * tally.translation, tally.nees,
              tally.worst, tally.noted);
  return tally;
}

/// Real pairs of a VLP-16 show beams of more than a centimetre (docs/method.md).
TEST(WideBeams, ThreeViewsAreNotSureThatThereAreNone) {
  const Tally wide = calibrations("vlp16_blackfly_a3", 0.012, 3, 60);
  EXPECT_GT(wide.answers, 45);
  EXPECT_LT(wide.nees, 1.5);
  EXPECT_LT(wide.worst, 9);
}

TEST(WideBeams, NorAreFive) {
  const Tally points = calibrations("os0_manta", 0, 5, 60), wide = calibrations("os0_manta", 0.003, 5, 60);
  EXPECT_LT(points.nees, 1.5);
  EXPECT_EQ(points.noted, 0);
  EXPECT_LT(wide.nees, 1.2);
  EXPECT_LT(wide.worst, 5);
}

TEST(WideBeams, FifteenViewsTellThem) {
  const Tally points = calibrations("os0_manta", 0, 15, 30), wide = calibrations("os0_manta", 0.012, 15, 30);
  EXPECT_LT(wide.nees, 1.5);
  EXPECT_LT(wide.translation, 1.5 * points.translation);
  EXPECT_EQ(points.noted, 0);
  EXPECT_GT(wide.noted, wide.answers / 2);
}

}  // namespace
}  // namespace ca2
