/// @file Do rims say something else than the planes?
#pragma once

#include "core/solve/joint_solver.h"

namespace ca2 {

/// Does `answer` lie further from the one `without` rims than that one's covariance allows?
bool contradicts(const JointAnswer& answer, const JointAnswer& without);

}  // namespace ca2
