/// @file The Brown-Conrady lens distortion, polynomial or rational, as OpenCV defines it; shared by the
/// pinhole models.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/camera/camera_model.h"

namespace ca2 {

/// With r^2 = x^2 + y^2 of the undistorted (normalised) point:
///   x' = x N / M + 2 p1 x y + p2 (r^2 + 2 x^2),   N = 1 + k1 r^2 + k2 r^4 + k3 r^6
///   y' = y N / M + p1 (r^2 + 2 y^2) + 2 p2 x y,   M = 1 + k4 r^2 + k5 r^4 + k6 r^6
/// The parameters follow fx fy cx cy in OpenCV's order: k1 k2 p1 p2 [k3 [k4 k5 k6]].
///
/// The domain is the largest disc on which every point's derivative matrix is surely positive definite. The
/// map is the gradient of a potential, so that it is one-to-one there.
std::optional<Eigen::Vector2d> brown_project(const CameraParameters& parameters, const Eigen::Vector3d& point,
                                             ProjectionJacobian* jacobian);

/// Unit direction of a pixel by damped Newton inside the domain, to 1e-9 px.
std::optional<Eigen::Vector3d> brown_unproject(const CameraParameters& parameters,
                                               const Eigen::Vector2d& pixel);

}  // namespace ca2
