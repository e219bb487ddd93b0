/// @file A chessboard whose white squares are printed on, found by its lattice and told by the print.
#pragma once

#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// What tells one white square from another, in parts of a square's side.
struct SquarePrint {
  int cells = 5;         ///< fields along a side, 8 at most
  double share = 0.5;    ///< of the side: what the fields take, in its middle
  double plain = 0.125;  ///< white along the square's edges
};

/// The corners of all pieces of chessboard in an 8-bit picture that show the board's print in one place only.
/// The board's first square is black, its corners are (columns - 1) x (rows - 1), row by row. In bounded
/// time, whatever the picture shows.
std::vector<Corner> find_by_print(const Board& board, const SquarePrint& print, const Image& grey8);

}  // namespace ca2
