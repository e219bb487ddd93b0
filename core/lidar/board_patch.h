/// @file Does a planar piece look like the board? Its rectangle, its returns, and how sure that is.
#pragma once

#include <optional>

#include "core/lidar/board_candidate.h"
#include "core/lidar/outline_fit.h"
#include "core/lidar/planar_regions.h"

namespace ca2 {

/// The board's rectangle laid over the piece, judged by what lies inside it (board), beyond its rim
/// (anything but more of the same plane) and by the plane's noise. None when it cannot be the board.
std::optional<BoardCandidate> judge_region(const PatchContext& context, const PlanarRegion& region);

}  // namespace ca2
