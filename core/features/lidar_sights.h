/// @file Pieces of a scan as the estimator takes them, for sessions and live scans alike.
#pragma once

#include <span>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/lidar/board_candidate.h"
#include "core/session/session.h"

namespace ca2 {

/// The candidates with the returns round them, in their order.
std::vector<LidarSight> sights_of(const Scan& scan, const Board& board,
                                  std::span<const BoardCandidate> candidates);

/// What may be the board, best first.
std::vector<LidarSight> find_sights(const Scan& scan, const Board& board);

/// The board where a person says it is.
Result<LidarSight> picked_sight(const Scan& scan, const Board& board, const Pick& pick);

}  // namespace ca2
