/// Beams that are wide where they leave the LiDAR see every plate too large by the same millimetres at any
/// distance: five views must not be sure of what that does to them, fifteen tell it.
#include <algorithm>
#include <cstdio>

#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

constexpr int trials = 30;

struct Tally {
  double nees = 0, translation = 0;  // means: per degree of freedom; m
  int noted = 0;
};

Tally calibrations(double beam_width, int views) {
  ScenarioFile file = load("os0_manta", 6200);
  for (auto& [name, lidar] : file.scenario.lidars) lidar.noise.beam_width = beam_width;
  for (auto& [name, camera] : file.scenario.cameras) camera.noise.corner_sigma = refined_corner_sigma;
  Tally tally;
  for (int trial = 0; trial < trials; ++trial) {
    ++file.scenario.seed;
    const auto answer = calibrate_features(rig_of(file.scenario), pool_of(file.scenario, views));
    if (!answer) throw std::runtime_error(answer.error().text());
    const CalibratedTransform& first = answer->transforms.front();
    const TransformError error = error_of(first, true_transform(file.scenario, first.parent, first.child));
    tally.nees += error.nees / (6 * trials);
    tally.translation += error.translation / trials;
    tally.noted += static_cast<int>(std::ranges::count_if(
        answer->notes, [](const std::string& note) { return note.find("rims lie") != std::string::npos; }));
  }
  std::printf("beams of %2.0f mm, %2d views: mean %.2f mm, NEES/6 %.2f, noted %d times\n", 1e3 * beam_width,
              views, 1e3 * tally.translation, tally.nees, tally.noted);
  return tally;
}

TEST(WideBeams, FiveViewsAreNotSureThatThereAreNone) {
  const Tally points = calibrations(0, 5), wide = calibrations(0.006, 5);
  EXPECT_LT(points.nees, 1.5);
  EXPECT_LT(wide.nees, 1.5);
  EXPECT_EQ(points.noted, 0);
}

TEST(WideBeams, FifteenViewsTellThem) {
  const Tally points = calibrations(0, 15), wide = calibrations(0.012, 15);
  EXPECT_LT(wide.nees, 1.5);
  EXPECT_LT(wide.translation, 1.5 * points.translation);
  EXPECT_EQ(points.noted, 0);
  EXPECT_GT(wide.noted, trials / 2);
}

}  // namespace
}  // namespace ca2
