/// @file The search for a whole checkerboard in a picture.
#pragma once

#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// The columns x rows inner corners row by row, as the board frame orders them (never mirrored; the top-left
/// square is black where the colours can tell), to about half a pixel; empty when the board is not there.
std::vector<Corner> find_checkerboard(int columns, int rows, const Image& grey8);

}  // namespace ca2
