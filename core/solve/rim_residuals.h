/// @file How far the sides of plates are from where they are held to be, and what that may come from.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/solve/edge_noise.h"

namespace ca2 {

/// A side's ends where its rays have them, less where it is predicted.
struct RimResidual {
  Eigen::Vector2d off;         ///< rad
  Eigen::Matrix2d covariance;  ///< rad^2, of its rays alone
  Eigen::Matrix2d by_sway;     ///< derivative, rad per m of the plate along its axes
  /// By the LiDAR's pose (left perturbation of T_lidar_board), the dilation's angle and margin, the rim's
  /// depth.
  Eigen::Matrix<double, 2, 9> by_common;
  double range = 0;  ///< m
  int freedom = 0;   ///< see EdgeSums
};

/// Of every view's sides; linear from here on.
using RimResiduals = std::vector<std::vector<RimResidual>>;
RimResiduals rim_residuals(std::span<const EdgeView> views, const Dilation& dilation, double blur,
                           double slack);

/// What the rims of all views are off by beyond their rays' gaps and the blur.
struct RimErrors {
  EdgeNoise noise;      ///< but for its blur; 0.05 mm of EdgeNoise::shared at least
  double deviance = 0;  ///< -2 log likelihood of the rims with these, but for a constant
  int freedom = 0;      ///< how much is known of the rims
};

/// The errors under which the sides lie off as they do with the most probability. No plate is cut, and no
/// print placed on it, to less than 0.05 mm.
RimErrors likeliest_errors(const RimResiduals& residuals);

/// The same after the LiDAR's pose, the dilation's angle and what is free were fitted to the rims.
RimErrors fitted_errors(RimResiduals residuals, const RimFreedom& free);

}  // namespace ca2
