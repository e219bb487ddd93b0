/// @file What one sensor says in one view, as normal equations.
#pragma once

#include <Eigen/Core>

#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"

namespace ca2 {

using Vector11d = Eigen::Matrix<double, 11, 1>;
using Matrix11d = Eigen::Matrix<double, 11, 11>;

/// Cost, gradient and Gauss-Newton matrix by a right perturbation of T_lidar_board (rotation, translation)
/// and the LiDAR's own numbers: range bias [m], the dilation's angle [rad] and margin [m], and range
/// slope [m].
struct SensorEquations {
  double cost = 0;
  Vector11d g = Vector11d::Zero();
  Matrix11d H = Matrix11d::Zero();
};

/// The same of T_camera_board, the camera's free parameters (the first so many of its model's) and, where it
/// is unknown, the print's stretch along x and y. Never allocates.
struct CameraEquations {
  static constexpr int most = 6 + max_camera_parameters + 2;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;

  explicit CameraEquations(Eigen::Index size = 6) : g(Vector::Zero(size)), H(Matrix::Zero(size, size)) {}

  double cost = 0;
  Vector g;
  Matrix H;
};

}  // namespace ca2
