/// @file What lies on a board: hands and clamps that stand out of it by little more than its ranges' noise.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geometry/plane.h"
#include "core/lidar/projection.h"
#include "core/lidar/ring_image.h"

namespace ca2 {

/// The returns (of the projection's scan, rising) whose rays meet `plane` within `radius` [m] of `centre` and
/// were stopped before it, with those beside them. Told from the mean over some centimetres, so that also a
/// finger is found where single returns do not stand out of their noise (`sigma`, m along the ray), and a
/// return's own noise hardly decides on it. What a ring errs by as a whole is taken out first.
std::vector<std::uint32_t> find_covered_returns(const Projection& projection, const RingImage& image,
                                                const Plane& plane, const Eigen::Vector3d& centre,
                                                double radius, double sigma);

}  // namespace ca2
