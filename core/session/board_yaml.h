/// @file A board as the `board:` key of YAML files.
#pragma once

#include <string>

#include "core/board/board.h"

namespace ca2 {

/// "board:" and its keys, exact; parse_rig gives the same board back.
std::string write_board(const Board& board);

}  // namespace ca2
