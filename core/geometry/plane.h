/// @file Planes, and their least-squares fit with covariance.
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/geometry/pose.h"

namespace ca2 {

/// The points p with n.p + d = 0; the unit normal n points towards the sensor, so d > 0.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0;  ///< d, m: the distance of the sensor's origin from the plane

  double distance(const Eigen::Vector3d& p) const { return normal.dot(p) + offset; }  ///< m, signed
  /// The plane's point nearest to the origin, -n d.
  Eigen::Vector3d foot() const { return -offset * normal; }
};

/// The same plane with its normal towards the origin.
Plane facing_origin(const Plane& plane);

/// The plane expressed in frame a, given in frame b; its normal faces a's origin.
Plane transform(const Pose& T_a_b, const Plane& plane);

/// The board's plane (board frame z = 0) in the sensor's frame.
Plane board_plane(const Pose& T_sensor_board);

/// Total least squares over the points (at least 3, not all on a line: otherwise the normal is arbitrary).
/// `rms`, where given, receives the root mean square distance, m.
Plane fit_plane(std::span<const Eigen::Vector3d> points, double* rms = nullptr);

}  // namespace ca2
