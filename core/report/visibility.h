/// @file Which points can be seen from a place, with no surface known.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace ca2 {

/// Indices of the points that are seen from the origin, rising, after Katz, Tal and Basri, "Direct visibility
/// of point sets" (2007): points are flipped to behind a sphere around the viewer, and those on the convex
/// hull are seen. `spacing` (rad) is the angle between neighbouring points; the sphere is chosen so that a
/// point about `depth` (m) or more behind the surface of its nearer neighbours is hidden. Points at the
/// origin are not seen.
std::vector<std::uint32_t> visible_from_origin(const std::vector<Eigen::Vector3d>& points, double spacing,
                                               double depth = 0.1);

}  // namespace ca2
