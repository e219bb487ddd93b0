/// @file How a solution moves when one of its views is left out.
#pragma once

#include <Eigen/Core>

#include "core/solve/joint_problem.h"

namespace ca2 {

/// [view x globals]: one Newton step with the view's share taken out of the marginal information, exact to
/// second order. `problem` is linearised at `state`, its minimum, `information` its information(). Empty
/// where the other views would not determine the answer.
Eigen::MatrixXd leave_one_out(JointProblem& problem, const JointState& state,
                              const Eigen::MatrixXd& information, std::size_t views);

}  // namespace ca2
