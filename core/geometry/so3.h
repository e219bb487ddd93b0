/// @file Rotations: exponential map, logarithm, and their derivatives.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace ca2 {

/// The matrix [v]x with [v]x w = v x w.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Rotation by |w| radians about w (Rodrigues).
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& w);

/// Inverse of so3_exp; the result's norm is in [0, pi], also close to pi.
Eigen::Vector3d so3_log(const Eigen::Matrix3d& R);

/// Right Jacobian: so3_exp(w + d) = so3_exp(w) so3_exp(J_r(w) d) to first order in d.
Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& w);

/// The rotation matrix nearest to M in the Frobenius norm.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M);

}  // namespace ca2
