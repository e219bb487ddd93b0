/// @file A chessboard whose squares are printed on, found by its lattice and told by the print: works where
/// single markers are too small to be read.
#pragma once

#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// What tells one square from another: `cells` x `cells` fields in the middle `share` of a square's side.
struct SquarePrint {
  int cells = 5;
  double share = 0.5;
};

/// The corners of the largest piece of chessboard in an 8-bit picture that shows the board's print in one
/// place only; empty where there is none. The board's corners are (columns - 1) x (rows - 1), row by row.
std::vector<Corner> find_by_print(const Board& board, const SquarePrint& print, const Image& grey8);

}  // namespace ca2
