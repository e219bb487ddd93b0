/// @file What the returns of the views in use err by, each by itself and all of a view together.
#pragma once

#include <span>
#include <vector>

#include "core/solve/joint_problem.h"

namespace ca2 {

/// Noise of one return by LiDAR, m, from the residuals to each view's own plane (3 degrees of freedom each),
/// with the biases and slopes of `state`; the input's where there is nothing to tell it from.
std::vector<double> range_noise(const JointInput& input, const JointState& state);

/// Takes the error that the returns of a view share, by LiDAR `view_sigma` [m], out of the views' sums.
void marginalize_view_errors(JointInput& input, std::span<const double> view_sigma);

}  // namespace ca2
