/// @file What rims say of where beams begin: where the points have them, or in a lens.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/features/sights.h"
#include "core/solve/edge_noise.h"
#include "core/solve/rim_residuals.h"

namespace ca2 {

/// How much more probable (natural logarithm of the ratio) rims are if beams begin in a lens `radius` [m] in
/// front of the axis instead of where the points have them, with `free` as found. The LiDAR's pose and the
/// dilation's angle are fitted to the rims either way. 0 where too few rims are seen to tell.
double lens_gain(std::span<const EdgeView> views, const Dilation& dilation, double blur, double slack,
                 const RimFreedom& free, double radius);

/// How far up the axis a beam in this direction through that lens meets it, m.
float height_through_lens(const Eigen::Vector3f& way, double radius);
void move_through_lens(EdgeCrossing& crossing, double radius);

}  // namespace ca2
