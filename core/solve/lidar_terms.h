/// @file A LiDAR's sums of one view as costs of the board's pose and of the LiDAR's own errors.
#pragma once

#include <span>

#include "core/geometry/pose.h"
#include "core/solve/edge_sums.h"
#include "core/solve/range_sums.h"
#include "core/solve/sensor_equations.h"

namespace ca2 {

/// A LiDAR's errors, see RangeSums and EdgeSums.
struct LidarErrors {
  double range_bias = 0;  ///< m
  Dilation dilation;
  double rim_depth = 0;    ///< m, see JointState
  double range_slope = 0;  ///< m per sine of the elevation
};

/// The cost of the ranges, `sigma` [m] being the noise of one; infinite where the board's plane meets the
/// LiDAR. Where `equations` are given, its derivatives are added to them (the cost is not).
double add_ranges(const RangeSums& sums, double sigma, const Pose& T_lidar_board, const LidarErrors& errors,
                  SensorEquations* equations);

/// The same of the plate's rim, `sway` [m] being EdgeNoise::sway.
double add_edges(std::span<const EdgeSums> edges, double sway, const Pose& T_lidar_board,
                 const LidarErrors& errors, SensorEquations* equations);

}  // namespace ca2
