/// @file Where a joint solve begins: nothing estimated yet but the seed's places.
#pragma once

#include <cstddef>
#include <vector>

#include "core/solve/joint_solver.h"

namespace ca2 {

/// Without views.
JointInput first_input(const Board& board, const std::vector<Camera>& cameras, std::size_t lidars,
                       const JointOptions& options);
JointState first_state(const std::vector<Camera>& cameras, std::size_t lidars,
                       const std::vector<ViewSights>& views, const RigSeed& seed);
/// No view is in use.
JointAnswer first_answer(std::size_t cameras, std::size_t lidars, std::size_t views, const RigSeed& seed);

}  // namespace ca2
