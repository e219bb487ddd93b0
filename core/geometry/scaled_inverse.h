/// @file The inverse of an information matrix whose units differ by orders of magnitude.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace ca2 {

/// Inverse of a symmetric positive definite matrix, scaled to a unit diagonal first (metres, radians and
/// pixels side by side); nothing where it is singular to working precision: the data then does not determine
/// some direction.
std::optional<Eigen::MatrixXd> scaled_inverse(const Eigen::MatrixXd& matrix);

}  // namespace ca2
