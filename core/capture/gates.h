/// @file Is what a sensor sees of the board good enough for a view? If not, why, for a person.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/session/rig.h"

namespace ca2 {

/// `pose`: nothing where the camera's intrinsics are not known. Empty: good.
std::string judge_camera(const std::string& name, const Board& board, const std::vector<Corner>& corners,
                         const std::optional<BoardPose>& pose);

/// `sight` is that of one scan.
std::string judge_lidar(const std::string& name, const LidarSight& sight);

/// The cameras once more, on what the search finds in the stored view: while the board is carried its corners
/// are only as good as tracking needs them, and blur shows when they are refined.
std::string judge_stored(const Rig& rig, const ViewSights& view);

}  // namespace ca2
