/// What a LiDAR's rims cost, where the whole plate may be off its pose.
#include "core/solve/lidar_terms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/solve/rim_scan.h"

namespace ca2 {
namespace {

const Pose T = plate_at(0.6);
const LidarErrors errors{0, {0.001, 0.002}, 0.003, 0};

std::vector<EdgeSums> edges() {
  const Pose seen{T.R, T.t + 0.004 * T.R.col(0) - 0.003 * T.R.col(1)};
  return edge_sums(scan_rim(seen, {.phase = 0.3, .dilation = errors.dilation, .depth = errors.rim_depth}),
                   test_plate, T, errors.dilation, {1e-4, 5e-4, 0}, 0.02);
}

TEST(LidarTerms, ASwayIsWhereThePlateIsMostProbable) {
  constexpr double sway = 0.002;  // m
  const std::vector<EdgeSums> seen = edges();
  const auto cost_at = [&](const Pose& pose, double its_sway) {
    return add_edges(seen, its_sway, pose, errors, nullptr);
  };
  double least = std::numeric_limits<double>::infinity();
  for (double x = -0.006; x < 0.006; x += 1e-4) {
    for (double y = -0.006; y < 0.006; y += 1e-4) {
      const Pose off{T.R, T.t + x * T.R.col(0) + y * T.R.col(1)};
      least = std::min(least, cost_at(off, 0) + 0.5 * (x * x + y * y) / (sway * sway));
    }
  }
  EXPECT_NEAR(cost_at(T, sway), least, 0.01 * least);
  EXPECT_LT(cost_at(T, sway), 0.5 * cost_at(T, 0));
}

TEST(LidarTerms, APlateThatMaySwayFarTellsNothingOfItsPlaceButOfItsTurn) {
  SensorEquations held, swaying;
  add_edges(edges(), 0, T, errors, &held);
  add_edges(edges(), 1, T, errors, &swaying);
  for (const Eigen::Index k : {3, 4}) EXPECT_LT(swaying.H(k, k), 1e-4 * held.H(k, k));
  EXPECT_GT(swaying.H(2, 2), 0.3 * held.H(2, 2));
}

}  // namespace
}  // namespace ca2
