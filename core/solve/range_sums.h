/// @file The returns of a board patch reduced to a few sums, so that a solve hardly depends on their number.
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/features/sights.h"
#include "core/geometry/plane.h"

namespace ca2 {

/// A plane that misses the origin as the vector q with q.p = 1 for its points: the range along the unit ray u
/// is 1 / (u.q), smooth in q.
Eigen::Vector3d inverse_plane(const Plane& plane);

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// Quadratic model of 1/2 sum w_i (rho_i - b - s sin(e_i) - (1 - o_i.q)/(u_i.q))^2, in m^2, over the returns
/// of one patch, o where their rays begin, rho how far along these they lie, e their elevations, around q =
/// `reference`, b = s = 0:  cost + gradient.z + 1/2 z'Hz with z = (q - reference, b, s). The range residual
/// is linearised at the predicted point, where the ray meets the reference plane: linearised at the measured
/// point the noise enters the weights and the answer is biased.
struct RangeSums {
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  Matrix5d H = Matrix5d::Zero();
  Vector5d gradient = Vector5d::Zero();
  double cost = 0;    ///< m^2
  double weight = 0;  ///< sum of the weights: the effective number of returns

  /// The same with what all these returns err by together marginalised out: a displacement of the plane at
  /// the patch's centre with standard deviation `shared` [m] and tilts with `shared` radians per metre,
  /// beside `sigma` [m] of one return. More returns then tell no more than that.
  RangeSums with_shared_error(double shared, double sigma) const;

  /// z of a plane, given as `inverse_plane`, a bias and a slope.
  Vector5d z(const Eigen::Vector3d& inverse, double bias, double slope) const {
    return (Vector5d() << inverse - reference, bias, slope).finished();
  }
  /// Sum of squares about the plane that fits these returns best, m^2.
  double about_own_plane(double bias, double slope) const;
  /// The cost at z, m^2.
  double at(const Vector5d& z) const { return cost + gradient.dot(z) + 0.5 * z.dot(H * z); }
};

/// The sums over `returns`, each with weight 1 where its residual to the reference plane with bias `bias` is
/// within `gate` metres, otherwise 0.
RangeSums range_sums(std::span<const BoardReturn> returns, const Eigen::Vector3d& reference, double bias,
                     double gate);

}  // namespace ca2
