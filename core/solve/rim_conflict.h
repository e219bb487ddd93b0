/// @file Do rims say something else than the planes?
#pragma once

#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/solve/joint_solver.h"
#include "core/types/result.h"

namespace ca2 {

/// Is an answer's `change` (rotation rad, translation m) more than the `covariance` of one of both allows?
bool beyond_chance(const Vector6d& change, const Matrix6d& covariance);

/// Does `answer` lie further from the one `without` rims than that one's covariance allows?
bool contradicts(const JointAnswer& answer, const JointAnswer& without);

/// One or two views have rims and ranges agree by a range bias as large as it takes: one that no LiDAR has,
/// held to 0 by `prior_bias` [m], is told as what it is. Empty where there is none, and for more views.
std::vector<Problem> unlikely_ranges(const std::vector<std::string>& lidars, const JointAnswer& answer,
                                     double prior_bias);

}  // namespace ca2
