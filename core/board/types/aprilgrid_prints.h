/// @file What is printed on the tags of an AprilGrid, by libapriltag's codes.
#pragma once

#include <array>
#include <vector>

namespace ca2 {

inline constexpr int aprilgrid_border = 2;  ///< cells
inline constexpr int aprilgrid_cells = 6 + 2 * aprilgrid_border;

/// White cells of every tag, [id][row][column] with the border's.
using AprilPrints = std::vector<std::array<std::array<bool, aprilgrid_cells>, aprilgrid_cells>>;
const AprilPrints& aprilgrid_prints();

}  // namespace ca2
