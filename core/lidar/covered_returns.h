/// @file What lies on a board: hands and clamps that stand out of it by little more than its ranges' noise.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/plane.h"
#include "core/lidar/patch_view.h"
#include "core/lidar/projection.h"
#include "core/lidar/ring_image.h"

namespace ca2 {

/// How far from a board's centre what covers it is looked for, m.
double covered_reach(double width, double height);

/// Of all rays that view_patch sees in `plane` within that of `centre`, with whatever band: the returns (of
/// the projection's scan, rising) that were stopped before the plane, with those beside them. Told from the
/// mean over some centimetres, so that also a finger is found where single returns do not stand out of their
/// noise (`sigma`, m along the ray), and a return's own noise hardly decides on it. What a ring errs by as a
/// whole is taken out first.
std::vector<std::uint32_t> find_covered_returns(const Projection& projection, const RingImage& image,
                                                const Plane& plane, const Eigen::Vector3d& centre,
                                                std::span<const PatchRay> rays, double sigma);

}  // namespace ca2
