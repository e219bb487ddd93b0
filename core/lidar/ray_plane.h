/// @file Planes as rays see them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/geometry/plane.h"

namespace ca2 {

/// How far behind (positive) or before the plane a return is, along its ray
/// from the origin, m.
double range_residual(const Plane& plane, const Eigen::Vector3d& point);

struct RangeFit {
  Plane plane;
  double rms = 0;    ///< m, along the rays, over the points within `reach`
  double sigma = 0;  ///< m, robust noise scale along the rays
};

/// The plane that best explains ranges along their rays (noise of a LiDAR lies
/// along the ray; distances of the noisy points to the plane would pull it),
/// with Tukey weights at a scale found from the data. Starts from `start`;
/// deterministic. At least 3 points not on a line: otherwise `start` comes
/// back.
RangeFit fit_ranges(std::span<const Eigen::Vector3d> points, const Plane& start);

}  // namespace ca2
