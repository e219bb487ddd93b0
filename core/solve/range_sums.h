/// @file The returns of a board patch reduced to a few sums, so that a solve hardly depends on their number.
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/features/sights.h"
#include "core/geometry/plane.h"
#include "core/solve/range_correction.h"

namespace ca2 {

/// A plane that misses the origin as the vector q with q.p = 1 for its points: the range along the unit ray u
/// is 1 / (u.q), smooth in q.
Eigen::Vector3d inverse_plane(const Plane& plane);

/// Quadratic model of 1/2 sum w_i (rho_i - b - 1/(u_i.q))^2, in m^2, over the returns of one patch, around
/// q = `reference`, b = 0:  cost + gradient.z + 1/2 z'Hz with z = (q - reference, b).
/// The range residual is linearised at the predicted point, where the ray meets the reference plane:
/// linearised at the measured point the noise enters the weights and the answer is biased.
struct RangeSums {
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  double cost = 0;    ///< m^2
  double weight = 0;  ///< sum of the weights: the effective number of returns

  /// The same with what all these returns err by together marginalised out: a displacement of the plane at
  /// the patch's centre with standard deviation `shared` [m] and tilts with `shared` radians per metre,
  /// beside `sigma` [m] of one return. More returns then tell no more than that.
  RangeSums with_shared_error(double shared, double sigma) const;

  /// The cost at (q, b), m^2.
  double at(const Eigen::Vector4d& z) const { return cost + gradient.dot(z) + 0.5 * z.dot(H * z); }
};

/// The sums over `returns`, their ranges corrected, each with weight 1 where its residual to the reference
/// plane with bias `bias` is within `gate` metres, otherwise 0.
RangeSums range_sums(std::span<const BoardReturn> returns, const Eigen::Vector3d& reference, double bias,
                     double gate, const RangeCorrection& correction = {});

/// The plane that fits the ranges best in the least-squares sense, started from `plane`; the residuals are
/// along the rays. Returns within `gate` of the current plane take part. `sums`, where given, are those at
/// the answer.
Plane fit_plane_along_rays(std::span<const BoardReturn> returns, const Plane& plane, double gate,
                           RangeSums* sums = nullptr, const RangeCorrection& correction = {});

}  // namespace ca2
