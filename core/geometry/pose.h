/// @file Rigid transforms. `T_a_b` maps points of frame b to frame a: p_a = T_a_b * p_b.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/so3.h"

namespace ca2 {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// An element of SE(3). Uncertainty and updates are right perturbations in the order (rotation, translation):
/// T(d) = T * (so3_exp(d.head(3)), d.tail(3)).
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< m

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R * p + t; }
  Pose operator*(const Pose& other) const { return {R * other.R, R * other.t + t}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * t)}; }

  /// The pose after the right perturbation d = (rotation [rad], translation [m]).
  Pose perturbed(const Vector6d& d) const { return {R * so3_exp(d.head<3>()), t + R * d.tail<3>()}; }

  /// The d with `perturbed(d) == other`.
  Vector6d difference(const Pose& other) const {
    Vector6d d;
    d << so3_log(R.transpose() * other.R), R.transpose() * (other.t - t);
    return d;
  }

  /// Unit quaternion with w >= 0.
  Eigen::Quaterniond quaternion() const {
    Eigen::Quaterniond q(R);
    q.normalize();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    return q;
  }

  static Pose from_quaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& t) {
    return {q.normalized().toRotationMatrix(), t};
  }
};

}  // namespace ca2
