/// @file The virtual camera's picture of a board: flat light, a pinhole, no noise.
#pragma once

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/types/image.h"

namespace ca2 {

/// Every pixel is the mean over its area, 0 (black) to 255. `camera` must be a pinhole without distortion.
GreyImage board_picture(const Board& board, const Camera& camera, const Pose& T_camera_board);

}  // namespace ca2
