/// @file Whether a board that was found nowhere is there with other counts: squares are taken for inner
/// corners.
#pragma once

#include <optional>
#include <span>

#include "core/board/board.h"
#include "core/features/search.h"

namespace ca2 {

struct OtherCounts {
  int columns = 0, rows = 0;
  std::filesystem::path picture;  ///< where it was seen
};

/// Of a sensor in whose pictures the board was found nowhere: one more or less along either side, looked for
/// in a few of them. Nothing for boards whose parts are told apart: they would be found by a part.
std::optional<OtherCounts> find_other_counts(const Board& board, std::span<const SensorFile> files,
                                             const std::string& sensor);

}  // namespace ca2
