/// @file How well an answer of the joint solver is known.
#pragma once

#include <cstddef>

#include "core/solve/joint_solver.h"

namespace ca2 {

/// The covariance of the answer, inflated by its `variance_factor`, and from four views on what each of the
/// `views` in use moves it by. Infinite where something is not determined. `problem`: linearised at `state`.
void add_covariance(JointAnswer& answer, JointProblem& problem, const JointState& state, std::size_t views);

/// Is it out of the question that rims lie in the print's plane and are seen too large by an angle only?
/// `state`: the answer's, of the views in use.
bool rims_lie_off(const JointAnswer& answer, const JointProblem& problem, const JointState& state);

}  // namespace ca2
