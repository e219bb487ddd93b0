#include "core/geometry/so3.h"

#include <Eigen/SVD>
#include <cmath>

namespace ca2 {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& w) {
  const double squared = w.squaredNorm();
  // Below 1e-4 rad the series' next terms are under 1e-17.
  double a = 1 - squared / 6;
  double b = 0.5 - squared / 24;
  if (squared > 1e-8) {
    const double angle = std::sqrt(squared);
    a = std::sin(angle) / angle;
    b = (1 - std::cos(angle)) / squared;
  }
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& R) {
  // Through the quaternion: stable near pi, where the antisymmetric part of R vanishes.
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-8) return 2 * q.vec();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& w) {
  const double squared = w.squaredNorm();
  double a = 0.5 - squared / 24;
  double b = 1.0 / 6 - squared / 120;
  if (squared > 1e-8) {
    const double angle = std::sqrt(squared);
    a = (1 - std::cos(angle)) / squared;
    b = (angle - std::sin(angle)) / (squared * angle);
  }
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() - a * W + b * W * W;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace ca2
