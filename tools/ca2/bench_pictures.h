/// @file Generated pictures to search boards in.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

struct BenchPicture {
  std::string kind;
  Image image;  ///< 8-bit grey
};

/// Views of a board through `camera`, whole in the picture, between `nearest` and `farthest` m away and up to
/// `off_axis` rad from the optical axis, tilted up to 60 degrees, before clutter.
std::vector<BenchPicture> board_pictures(const std::string& kind, const Board& board, const Camera& camera,
                                         double off_axis, double nearest, double farthest, int count,
                                         std::mt19937_64& random);

/// What searches stumble over: texture, foliage, a keyboard, blinds, windows, a checkered floor; `each` of
/// every kind.
std::vector<BenchPicture> hard_pictures(int width, int height, int each, std::mt19937_64& random);

}  // namespace ca2
