/// @file The least error any estimate from a set of simulated views can have, computed at the truth.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/session/rig.h"
#include "tools/sim/feature_simulator.h"

namespace ca2 {

/// What the bound lets an estimate know.
struct BoundModel {
  bool edges = false;  ///< where the rings enter and leave the plate, beside corners and ranges
  /// Standard deviations with which intrinsics and range biases are known beforehand; 0: exactly.
  double prior_focal = 0;   ///< relative
  double prior_center = 0;  ///< px
  double prior_bias = 0;    ///< m
};

/// The Cramer-Rao bound on the covariance (rotation, translation; right perturbation) of T_camera_lidar of
/// the rig's first camera and first LiDAR, the board's poses being free. Nothing where the views do not
/// determine it, or where the noise is zero.
///
/// Corners and ranges err by independent Gaussian noise of known size, so that their information is J'J /
/// sigma^2 at the truth: of every corner by its reprojection, of every return by where its ray meets the
/// board.
///
/// Edges: the rings tell of a straight rim that it crosses the gap between two rays, anywhere with the same
/// chance. A uniform error has no Fisher information; what stands in for it is the information of the best
/// linear estimate. One crossing of a gap of width w has variance w^2 / 12. Let the rim sit at the offset x,
/// uniform over many gaps: crossing i reports the middle of its gap, and its error is a saw tooth in x with
/// period w_i and the phase phi_i in which ray and rim stand. Two saw teeth of one period whose phases differ
/// by the share s of it have the covariance w^2/12 (1 - 6 s (1 - s)) - their Fourier series are sums of
/// sin(2 pi k x / w) / (pi k), whose products average to sum of cos(2 pi k s) / (2 pi^2 k^2), times w^2. With
/// C made of these, J'C^-1 J is the information of the side's plane (through the LiDAR) and of the dilation,
/// the angle by which beams see the plate too large, which is known to `dilation_sigma`. Rings that cut their
/// gaps at one place make C singular and count once; rings that cut it at n places leave w^2/12 / n^2.
std::optional<Matrix6d> cramer_rao(const Scenario& scenario, const Rig& rig,
                                   const std::vector<SimulatedView>& views, const BoundModel& model);

}  // namespace ca2
