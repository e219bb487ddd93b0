/// @file The board found again near where it is expected: what a search costs when the last picture had it.
#pragma once

#include <span>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// Looks for the corners round `expected` (the last picture's, moved on as far as that is known; at least 6),
/// each within a third of the distance to its neighbours, and for those that were missing where their
/// neighbours predict them. The corners are those BoardType::find would give, with the ids of `expected`;
/// part of them may be covered. Empty when it is not the same board in the same place: too few corners, a
/// lattice out of shape, or a print that does not fit (a shift by one square does not).
std::vector<Corner> track_board(const Board& board, const Image& grey8, std::span<const Corner> expected);

}  // namespace ca2
