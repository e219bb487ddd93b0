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
/// Edges: the rim crosses the gap between two rays anywhere with the same chance. A uniform error has no
/// Fisher information: what stands in for it is the inverse of the least mean square error. A straight rim
/// has two unknowns per side, its angles u and v at its ends; a ray that ended on the plate leaves those with
/// a u + b v >= its own angle, its neighbour those with <=, a and b being where along the side it passes. All
/// rays of a side leave a convex polygon in (u, v), any point of it being as likely (nothing is known of the
/// rim beforehand), so that its mean is the best estimate and its covariance C the mean square error of that:
/// no estimate from these crossings has less. J'C^-1 J is then the information of the side's plane (through
/// the LiDAR) and of the dilation, the angle by which beams see the plate too large, known to
/// `dilation_sigma`. Correlated crossings need no rule of their own: rings that cut their gaps at one place
/// leave the whole gap w, a variance of w^2/12; rings that cut it at n places leave w/n. The rim is held to
/// be straight to 0.1 mrad.
std::optional<Matrix6d> cramer_rao(const Scenario& scenario, const Rig& rig,
                                   const std::vector<SimulatedView>& views, const BoundModel& model);

}  // namespace ca2
