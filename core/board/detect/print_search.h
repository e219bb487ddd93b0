/// @file A board with prints between its corners, a ChArUco or an AprilGrid, found by its lattice of corners
/// and told by the prints.
#pragma once

#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// What tells one printed square from another, in parts of a square's side.
struct SquarePrint {
  int cells = 5;         ///< fields along a side, 8 at most
  double share = 0.5;    ///< of the side: what the fields take, in its middle
  double plain = 0.125;  ///< along the square's edges, on both sides
  /// Of a grid of tags, whose corners black squares in the gaps make a chessboard's: from tag to tag. Else
  /// the printed squares are a chessboard's white ones.
  double gap = 0;

  bool tags() const { return gap > 0; }
};

/// The corners of all pieces of the board in an 8-bit picture that show its print in one place only. Ids are
/// row by row; a chessboard has (columns - 1) x (rows - 1), its first square is black; a grid of tags has two
/// per tag and axis. In bounded time, whatever the picture shows.
std::vector<Corner> find_by_print(const Board& board, const SquarePrint& print, const Image& grey8);

}  // namespace ca2
