/// @file What one sensor says in one view, as normal equations.
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace ca2 {

using Vector10d = Eigen::Matrix<double, 10, 1>;
using Matrix10d = Eigen::Matrix<double, 10, 10>;

/// Cost, gradient and Gauss-Newton matrix by a right perturbation of T_sensor_board (rotation, translation)
/// and up to four numbers of the sensor's own: fx, fy, cx, cy [px] of a camera; range bias [m], dilation
/// [rad] and range slope [m] of a LiDAR.
struct SensorEquations {
  double cost = 0;
  Vector10d g = Vector10d::Zero();
  Matrix10d H = Matrix10d::Zero();
};

}  // namespace ca2
