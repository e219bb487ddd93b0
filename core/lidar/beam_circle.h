/// @file The circle on which the beams of a spinning LiDAR begin.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>

#include "core/lidar/scan_grid.h"

namespace ca2 {

/// About the frame's z axis.
struct BeamCircle {
  float radius = 0, height = 0;  ///< m

  /// Under which elevation a return is seen from the circle's point below it, rad.
  float elevation(const Eigen::Vector3f& p) const {
    return fast_azimuth(std::sqrt(p.x() * p.x() + p.y() * p.y()) - radius, p.z() - height);
  }
};

/// From where the returns lie on the fewest elevations: an OS0's on 128 from 28 mm before its axis and 38 mm
/// above its origin, and on none in particular from its origin. What is found need not be such a circle;
/// nothing where there are hardly any returns.
std::optional<BeamCircle> find_beam_circle(std::span<const Eigen::Vector3f> points);

}  // namespace ca2
