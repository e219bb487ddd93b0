/// @file Is what a sensor sees of the board good enough for a view? If not, why, for a person.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"

namespace ca2 {

/// `pose`: nothing where the camera's intrinsics are not known. Empty: good.
std::string judge_camera(const std::string& name, const Board& board, const std::vector<Corner>& corners,
                         const std::optional<BoardPose>& pose);

/// `sight` is that of one scan.
std::string judge_lidar(const std::string& name, const LidarSight& sight);

}  // namespace ca2
