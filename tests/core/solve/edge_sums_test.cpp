/// Crossings of a plate's rim by rings whose rays lie on a grid: what the sums say against the truth, over
/// many grids, and what tells nothing about the rim.
#include "core/solve/edge_sums.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/core/solve/rim_scan.h"

namespace ca2 {
namespace {

constexpr auto& outline = test_plate;

std::vector<EdgeCrossing> scan(const Pose& T_lidar_board, double phase, double dilation) {
  return scan_rim(T_lidar_board, {.phase = phase, .dilation = {dilation, 0}});
}

/// Minimises the sums over the place in the plane and the turn about the normal.
struct Fit {
  Eigen::Vector3d error;  // m, m, rad
  Eigen::Matrix3d covariance;
};
Fit fit(const Pose& truth, const std::vector<EdgeCrossing>& crossings, double dilation) {
  Pose T = truth;
  Eigen::Matrix3d H;
  for (int round = 0; round < 5; ++round) {
    H.setZero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const EdgeSums& edge : edge_sums(crossings, outline, T, {dilation, 0}, {}, 0.03)) {
      const Eigen::Vector4d z = edge.at(T, {dilation, 0});
      Eigen::Matrix<double, 4, 3> D;
      for (int k = 0; k < 3; ++k) {
        Vector6d d = Vector6d::Zero();
        d(k < 2 ? 3 + k : 2) = 1e-5;
        D.col(k) = (edge.at(T.perturbed(d), {dilation, 0}) - z) / 1e-5;
      }
      H += D.transpose() * edge.H * D;
      g += D.transpose() * edge.H * z;
    }
    const Eigen::Vector3d s = -H.inverse() * g;
    T = T.perturbed((Vector6d() << 0, 0, s(2), s(0), s(1), 0).finished());
  }
  const Vector6d d = truth.difference(T);
  return {{d(3), d(4), d(2)}, H.inverse()};
}

TEST(EdgeSums, ErrorsAreAsTheCovarianceSays) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(0, 1);
  // Upright, where all rings cut the same column gap; a little turned; a diamond.
  for (const double roll : {0.0, 0.02, 0.15, M_PI / 4}) {
    double nees = 0, squares = 0, variance = 0;
    constexpr int trials = 100;
    for (int trial = 0; trial < trials; ++trial) {
      const Pose T = plate_at(roll + 0.01 * (unit(rng) - 0.5));
      const double dilation = 0.002 * unit(rng);
      const Fit result = fit(T, scan(T, unit(rng), dilation), dilation);
      nees += result.error.dot(result.covariance.inverse() * result.error) / 3 / trials;
      squares += result.error.head<2>().squaredNorm() / trials;
      variance += result.covariance.topLeftCorner<2, 2>().trace() / trials;
    }
    std::printf("roll %.2f: rms %.2f mm, predicted %.2f mm, NEES/3 %.2f\n", roll, 1e3 * std::sqrt(squares),
                1e3 * std::sqrt(variance), nees);
    EXPECT_GT(nees, 0.3) << roll;
    EXPECT_LT(nees, 2.0) << roll;
  }
}

TEST(EdgeSums, RingsThatCutTheSameGapCountOnce) {
  const Pose T = plate_at(0);
  std::vector<EdgeCrossing> crossings = scan(T, 0.3, 0);
  const auto information = [&](const std::vector<EdgeCrossing>& list) {
    double sum = 0;
    for (const EdgeSums& edge : edge_sums(list, outline, T, {}, {1e-5, 0, 0}, 0.03)) sum += edge.H(3, 3);
    return sum;
  };
  const double once = information(crossings);
  const std::size_t count = crossings.size();
  for (std::size_t i = 0; i < count; ++i) crossings.push_back(crossings[i]);
  const double twice = information(crossings);
  EXPECT_LT(twice, 1.5 * once);
  EXPECT_GE(twice, once);
}

TEST(EdgeSums, CoveredAndForeignCrossingsTellNothing) {
  const Pose T = plate_at(0.2);
  std::vector<EdgeCrossing> crossings = scan(T, 0.3, 0);
  for (EdgeCrossing& crossing : crossings) crossing.jump = -0.2f;
  EXPECT_TRUE(edge_sums(crossings, outline, T, {}, {}, 0.03).empty());
  // Something in the plane of the board that sticks out: its rim is not the plate's.
  crossings = scan(T, 0.3, 0);
  const Pose elsewhere{T.R, T.t + 0.15 * T.R.col(0)};
  for (const EdgeSums& edge : edge_sums(crossings, outline, elsewhere, {}, {}, 0.03)) {
    EXPECT_GT(std::abs(edge.a.x() - edge.b.x()), 0.1) << "an upright side from 0.15 m beside it";
  }
  EXPECT_TRUE(edge_sums({}, outline, T, {}, {}, 0.03).empty());
}

TEST(EdgeSums, TheCentreIsSeenWhereItIs) {
  const Pose T = plate_at(0.4);
  const std::vector<EdgeCrossing> crossings = scan(T, 0.3, 0.001);
  const Pose moved{T.R, T.t + 0.008 * T.R.col(0) - 0.006 * T.R.col(1)};
  const auto offset = center_offset(edge_sums(crossings, outline, moved, {}, {}, 0.03), moved, {});
  ASSERT_TRUE(offset);
  EXPECT_NEAR(*offset, 0.010, 0.0015);
  EXPECT_FALSE(center_offset({}, T, {}));
}

}  // namespace
}  // namespace ca2
