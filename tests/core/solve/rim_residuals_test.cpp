/// What the sides of many plates are off by, as their rims show it.
#include "core/solve/rim_residuals.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "tests/core/solve/rim_scan.h"

namespace ca2 {
namespace {

constexpr double slack = 0.025, how_wide = 0.002;  // m, rad

/// Of twenty plates, 1.2 to 2.8 m away; what stands behind each makes it seem larger or smaller by so much
/// more (standard deviation, rad).
RimErrors errors_before(double backdrops) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::vector<EdgeCrossing>> crossings;
  std::vector<Pose> poses;
  for (int i = 0; i < 20; ++i) {
    Pose T = plate_at(0.8 + 0.4 * unit(rng));
    T.t = {2 + 0.8 * unit(rng), 0.3 * unit(rng), 0.4 * unit(rng)};
    poses.push_back(T);
    crossings.push_back(
        scan_rim(T, {.phase = 0.5 * unit(rng), .dilation = {how_wide + backdrops * normal(rng), 0}}));
  }
  std::vector<EdgeView> views;
  for (std::size_t i = 0; i < poses.size(); ++i) views.push_back({crossings[i], test_plate, poses[i]});
  return likeliest_errors(rim_residuals(views, {how_wide, 0}, 0, slack));
}

TEST(RimResiduals, SidesThatLieWhereTheyShouldAreBelieved) {
  const EdgeNoise noise = errors_before(0).noise;
  EXPECT_LE(noise.shared, 0.0001);
  EXPECT_EQ(noise.backdrop, 0);
  EXPECT_EQ(noise.sway, 0);
}

TEST(RimResiduals, BackdropsShow) {
  const EdgeNoise noise = errors_before(0.0005).noise;
  EXPECT_GT(noise.backdrop, 0.0002);
  EXPECT_LT(noise.backdrop, 0.001);
}

/// Derivatives, against moves of the plate in the sensor's frame, of its dilation and depth, and of its sway.
TEST(RimResiduals, DerivativesAreThoseOfMoves) {
  const Pose T = plate_at(0.3);
  const Dilation dilation{how_wide, 0};
  const auto crossings = scan_rim(T, {.phase = 0.2, .dilation = dilation});
  const EdgeView view{crossings, test_plate, T};
  const auto sides = edge_sums(crossings, test_plate, T, dilation, {}, slack);
  const RimResiduals residuals = rim_residuals(std::span(&view, 1), dilation, 0, slack);
  ASSERT_EQ(residuals.at(0).size(), sides.size());
  constexpr double step = 1e-6;  // rad, m
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto derivative = [&](const Pose& moved, const Dilation& seen) {
      return Eigen::Vector2d(sides[i].rows * (sides[i].at(moved, seen) - sides[i].at(T, dilation)) / step);
    };
    const auto along = [&](int axis) { return Pose{T.R, T.t + step * T.R.col(axis)}; };
    Eigen::Matrix<double, 2, 9> by_common;
    for (int k = 0; k < 6; ++k)
      by_common.col(k) = derivative(Pose{}.perturbed(step * Vector6d::Unit(k)) * T, dilation);
    by_common.col(6) = derivative(T, {dilation.angle + step, 0});
    by_common.col(7) = derivative(T, {dilation.angle, step});
    by_common.col(8) = derivative(along(2), dilation);
    EXPECT_LT((residuals[0][i].by_common - by_common).lpNorm<Eigen::Infinity>(), 1e-5);
    EXPECT_LT((residuals[0][i].by_sway.col(0) - derivative(along(0), dilation)).norm(), 1e-5);
    EXPECT_LT((residuals[0][i].by_sway.col(1) - derivative(along(1), dilation)).norm(), 1e-5);
  }
}

/// A backdrop moves a side, it does not turn it.
TEST(RimResiduals, BackdropsLeaveDirectionsAlone) {
  const Pose T = plate_at(0.3);
  const auto crossings = scan_rim(T, {.phase = 0.2, .dilation = {how_wide, 0}});
  const auto sides = edge_sums(crossings, test_plate, T, {how_wide, 0}, {}, slack);
  ASSERT_EQ(sides.size(), 4u);
  for (EdgeSums edge : sides) {
    const auto variance = [&](const Eigen::Vector2d& of_ends) {
      const Eigen::Matrix<double, 4, 2> inverse =
          edge.rows.transpose() * (edge.rows * edge.rows.transpose()).inverse();
      return of_ends.dot((inverse.transpose() * edge.H * inverse).inverse() * of_ends);
    };
    const Eigen::Vector2d offset(0.5, 0.5), direction(1, -1);
    const double offset_before = variance(offset), direction_before = variance(direction);
    edge.share({0, 0, 0.001, 0});
    EXPECT_NEAR(variance(offset), offset_before + 1e-6, 1e-9);
    EXPECT_NEAR(variance(direction) / direction_before, 1, 1e-6);
  }
}

}  // namespace
}  // namespace ca2
