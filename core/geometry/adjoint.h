/// @file How perturbations change sides of a transform.
#pragma once

#include "core/geometry/pose.h"

namespace ca2 {

/// For right perturbations (rotation, translation): T exp(d) = exp(adjoint(T) d) T.
inline Matrix6d adjoint(const Pose& T) {
  Matrix6d Ad;
  Ad << T.R, Eigen::Matrix3d::Zero(), skew(T.t) * T.R, T.R;
  return Ad;
}

}  // namespace ca2
