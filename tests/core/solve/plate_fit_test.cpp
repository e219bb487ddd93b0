/// A plate found again by its rim, from nothing but the patch's plane and its crossings.
#include "core/solve/plate_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/core/solve/rim_scan.h"

namespace ca2 {
namespace {

/// The patch of a plate at T_lidar_board as a finder gives it: some returns, a rough centre, and its rim.
LidarSight patch_at(const Pose& T_lidar_board, double phase, double dilation) {
  LidarSight sight;
  sight.plane = board_plane(T_lidar_board);
  sight.center = T_lidar_board * Eigen::Vector3d(0.03, 0.02, 0);
  sight.rms = 0.005;
  for (double x = -0.28; x < 0.28; x += 0.04) {
    for (double y = -0.18; y < 0.18; y += 0.04) {
      const Eigen::Vector2d p = test_plate.center + Eigen::Vector2d(x, y);
      BoardReturn& here = sight.on_board.emplace_back();
      here.point = (T_lidar_board * Eigen::Vector3d(p.x(), p.y(), 0)).cast<float>();
    }
  }
  sight.crossings = scan_rim(T_lidar_board, {.phase = phase, .dilation = {dilation, 0}});
  return sight;
}

/// Of the plate's centre, which way round being left open.
Vector6d error(const PlateFit& fit, const Pose& T_lidar_board) {
  Pose truth = T_lidar_board;
  truth.t = T_lidar_board * Eigen::Vector3d(test_plate.center.x(), test_plate.center.y(), 0);
  if (truth.R.col(0).dot(fit.T_lidar_plate.R.col(0)) < 0) truth.R.leftCols<2>() *= -1;
  return truth.difference(fit.T_lidar_plate);
}

TEST(PlateFit, FindsThePlateHoweverItIsTurned) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(0, 1);
  double nees = 0;
  int trials = 0;
  for (double roll = 0; roll < M_PI; roll += 0.13) {
    const Pose T = plate_at(roll);
    const auto fits = fit_plate(patch_at(T, unit(rng), 0.002 * unit(rng)), test_plate, 0.002);
    ASSERT_EQ(fits.size(), 1u) << roll;
    const Vector6d d = error(fits[0], T);
    EXPECT_LT(d.tail<3>().norm(), 0.004) << roll;
    EXPECT_LT(d.head<3>().norm(), 0.01) << roll;
    EXPECT_NEAR(fits[0].T_lidar_plate.R.col(2).dot(T.R.col(2)), 1, 1e-9);
    const Eigen::Vector3d in_plane(d(2), d(3), d(4));
    const Eigen::Matrix3d covariance = fits[0].covariance.block<3, 3>(2, 2);
    EXPECT_LT(std::sqrt(covariance.diagonal().tail<2>().maxCoeff()), 0.005) << roll;
    nees += in_plane.dot(covariance.ldlt().solve(in_plane)) / 3;
    ++trials;
  }
  EXPECT_LT(nees / trials, 1.5);
}

TEST(PlateFit, APlateOfAnotherSizeIsAnotherThing) {
  for (double roll = 0; roll < M_PI; roll += 0.31) {
    const LidarSight sight = patch_at(plate_at(roll), 0.3, 0);
    EXPECT_EQ(fit_plate(sight, test_plate, 0.002).size(), 1u);
    for (const double size : {0.8, 1.2}) {
      EXPECT_TRUE(fit_plate(sight, {size * 0.6, size * 0.4, {}}, 0.002).empty()) << roll << " " << size;
    }
    EXPECT_TRUE(fit_plate(sight, {0.49, 0.49, {}}, 0.002).empty()) << roll;
  }
}

// Two rings only: a line passes through any two crossings of a side, and one stray turns it.
TEST(PlateFit, AFewCrossingsAreTooFew) {
  LidarSight sight = patch_at(plate_at(0.2), 0.3, 0);
  std::erase_if(sight.crossings, [](const EdgeCrossing& crossing) {
    return !crossing.across_rings && crossing.ring != 55 && crossing.ring != 65;
  });
  ASSERT_GE(sight.crossings.size(), 4u);
  EXPECT_TRUE(fit_plate(sight, test_plate, 0.002).empty());
}

TEST(PlateFit, WhatHasNoRimHasNoPlace) {
  LidarSight sight = patch_at(plate_at(0.2), 0.3, 0);
  sight.crossings.clear();
  EXPECT_TRUE(fit_plate(sight, test_plate, 0.002).empty());
}

}  // namespace
}  // namespace ca2
