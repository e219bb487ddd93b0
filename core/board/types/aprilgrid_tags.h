/// @file The tags of an AprilGrid in a picture, by libapriltag.
#pragma once

#include <array>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

inline constexpr int aprilgrid_border = 2;  ///< cells
inline constexpr int aprilgrid_cells = 6 + 2 * aprilgrid_border;

/// White cells of every tag, [id][row][column] with the border's.
using AprilPrints = std::vector<std::array<std::array<bool, aprilgrid_cells>, aprilgrid_cells>>;
const AprilPrints& aprilgrid_prints();

struct AprilTag {
  int column = 0, row = 0;  ///< in the grid, row from the top
  std::array<Eigen::Vector2d, 4>
      corners;        ///< px: top left, top right, bottom right, bottom left as the grid stands
  double margin = 0;  ///< of the decoding

  Eigen::Vector2d centre() const { return (corners[0] + corners[1] + corners[2] + corners[3]) / 4; }
};

/// The grid's tags, to about a pixel; deterministic.
std::vector<AprilTag> find_april_tags(const Board& board, const Image& grey8);

}  // namespace ca2
