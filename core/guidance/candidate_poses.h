/// @file Poses of the board that a camera sees whole.
#pragma once

#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// Places all over the picture, from as near as it fits to as far as its squares are told apart, facing the
/// camera or tilted by 35 degrees to eight sides: T_camera_board each, the board upright.
std::vector<Pose> candidate_poses(const Board& board, const Camera& camera);

}  // namespace ca2
