/// @file Extrinsics from pairs of planes: the closed form, and the two published methods kept as baselines.
#pragma once

#include <optional>
#include <span>

#include "core/geometry/plane.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// The board's plane as two sensors see it in one view.
struct PlanePair {
  Plane camera;
  Plane lidar;
};

/// T_camera_lidar in closed form: rotation by SVD of the normals, translation from the plane distances by
/// least squares (Kim and Park 2019, the method `kim`). Nothing where the normals do not span space: fewer
/// than three pairs, or the smallest singular value of the stacked camera normals over sqrt(n) under
/// `min_spread`.
std::optional<Pose> solve_closed_form(std::span<const PlanePair> pairs, double min_spread = 1e-6);

struct PlaneToPlaneResult {
  Pose T_camera_lidar;
  Matrix6d information = Matrix6d::Zero();  ///< of the unweighted residuals: scale by their variance
  double residual_variance = 0;
};

/// The published plane-to-plane method (Ca2Lib, Sapienza 2023): Gauss-Newton on SE(3) over
/// e = [n_c.(p(pi_c) - p(pi_l)); n_l - n_c], p(pi) = -n d, with a Huber kernel, from three pairs on, started
/// from the closed form. The LiDAR plane is moved to the camera's frame by the estimate.
std::optional<PlaneToPlaneResult> solve_plane_to_plane(std::span<const PlanePair> pairs, double huber = 0.1);

/// The published residuals' information and variance at a given answer, for methods that do not iterate.
PlaneToPlaneResult plane_to_plane_at(std::span<const PlanePair> pairs, const Pose& T_camera_lidar,
                                     double huber = 0.1);

}  // namespace ca2
