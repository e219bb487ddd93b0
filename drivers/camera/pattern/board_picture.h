/// @file The virtual camera's picture of a board: flat light, a pinhole, no noise.
#pragma once

#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// 0 (black) to 255 (white).
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<float> pixels;
};

/// Every pixel is the mean over its area. `camera` must be a pinhole without distortion.
GreyImage board_picture(const Board& board, const Camera& camera, const Pose& T_camera_board);

}  // namespace ca2
