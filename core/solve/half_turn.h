/// @file Half a turn of a pattern, or of a plate, that looks the same after it.
#pragma once

#include <vector>

#include "core/board/board.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// The pose when what lies there is turned by half a turn about its z axis.
Pose half_turned(const Pose& T_sensor_board);
/// The corner ids of a half-turned pattern: id -> count - 1 - id.
void turn_ids(std::vector<Corner>& corners, int count);

}  // namespace ca2
