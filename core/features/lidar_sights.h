/// @file Pieces of a scan as the estimator takes them, for sessions and live scans alike.
#pragma once

#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/lidar/board_candidate.h"
#include "core/session/session.h"

namespace ca2 {

/// The candidate with the returns round it.
LidarSight sight_of(const Scan& scan, const Board& board, const BoardCandidate& candidate);

/// What may be the board, best first.
std::vector<LidarSight> find_sights(const Scan& scan, const Board& board);

/// The board where a person says it is.
Result<LidarSight> picked_sight(const Scan& scan, const Board& board, const Pick& pick);

}  // namespace ca2
