#include "core/solve/range_sums.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace ca2 {

Eigen::Vector3d inverse_plane(const Plane& plane) {
  return -plane.normal / plane.offset;
}

RangeSums range_sums(std::span<const BoardReturn> returns, const Eigen::Vector3d& reference, double bias,
                     double gate, const RangeCorrection& correction) {
  RangeSums sums;
  sums.reference = reference;
  // d/dq of 1/(u.q) is -rho^2 u: in terms of the predicted point p = rho u, -rho p.
  Eigen::Matrix3d Hqq = Eigen::Matrix3d::Zero();
  Eigen::Vector3d Hqb = Eigen::Vector3d::Zero();
  Eigen::Vector3d gq = Eigen::Vector3d::Zero();
  double gb = 0;
  for (const BoardReturn& here : returns) {
    const Eigen::Vector3d p = here.point.cast<double>();
    const double range = p.norm();
    const double inverse = p.dot(reference) / range;
    if (!(inverse > 1e-6)) continue;  // the ray does not meet the plane ahead (or the point is not finite)
    const double predicted = 1 / inverse;
    const double residual = range - correction.at(here) - predicted;
    if (!(std::abs(residual - bias) <= gate)) continue;
    const Eigen::Vector3d jacobian = predicted * predicted / range * p;  // of the residual by q
    Hqq.noalias() += jacobian * jacobian.transpose();
    Hqb -= jacobian;
    gq += residual * jacobian;
    gb -= residual;
    sums.cost += 0.5 * residual * residual;
    sums.weight += 1;
  }
  sums.H.topLeftCorner<3, 3>() = Hqq;
  sums.H.topRightCorner<3, 1>() = Hqb;
  sums.H.bottomLeftCorner<1, 3>() = Hqb.transpose();
  sums.H(3, 3) = sums.weight;
  sums.gradient << gq, gb;
  return sums;
}

Plane fit_plane_along_rays(std::span<const BoardReturn> returns, const Plane& plane, double gate,
                           RangeSums* sums, const RangeCorrection& correction) {
  Eigen::Vector3d q = inverse_plane(plane);
  RangeSums current = range_sums(returns, q, 0, gate, correction);
  for (int i = 0; i < 10; ++i) {
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(current.H.topLeftCorner<3, 3>());
    const Eigen::Vector3d step = -ldlt.solve(current.gradient.head<3>());
    if (current.weight < 3 || ldlt.info() != Eigen::Success || !step.allFinite()) break;
    q += step;
    current = range_sums(returns, q, 0, gate, correction);
    if (step.norm() < 1e-12 * q.norm()) break;
  }
  if (sums) *sums = current;
  const double norm = q.norm();
  return {-q / norm, 1 / norm};
}

}  // namespace ca2
