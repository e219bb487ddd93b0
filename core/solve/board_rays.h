/// @file Which returns lie on the board, decided by where their rays meet it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"

namespace ca2 {

/// The returns of a sight whose rays meet the plate at least `margin` metres inside its outline, the plate
/// being at T_lidar_board. The noisy points themselves have no say: choosing by them would bias the answer.
std::vector<BoardReturn> returns_through_board(const LidarSight& sight, const Outline& outline,
                                               const Pose& T_lidar_board, double margin);

}  // namespace ca2
