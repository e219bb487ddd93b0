#include <algorithm>

#include "core/board/detect/lattice.h"

namespace ca2 {
namespace {

/// Mean length of the steps from line to line that cross a tag, over that of those that cross a gap; 0 where
/// either has none.
double tags_over_gaps(const Lattice& lattice, const Lines& lines) {
  double tags = 0, gaps = 0;
  int tag_count = 0, gap_count = 0;
  for (const auto& [cell, node] : lattice) {
    for (const Cell& axis : {Cell{1, 0}, Cell{0, 1}}) {
      const auto next = lattice.find(cell + axis);
      if (next == lattice.end()) continue;
      const double length = (next->second.saddle.pixel - node.saddle.pixel).norm();
      const int from = axis.first != 0 ? cell.first - lines.first.first : cell.second - lines.first.second;
      (from % 2 == 0 ? tags : gaps) += length;
      ++(from % 2 == 0 ? tag_count : gap_count);
    }
  }
  return tag_count > 0 && gap_count > 0 ? tags / tag_count / (gaps / gap_count) : 0;
}

}  // namespace

std::vector<Lines> possible_lines(const Lattice& lattice, const Squares& squares) {
  const auto& [cell, node] = *lattice.begin();
  const Cell bright = node.step[0] + node.step[1];
  const bool white = bright.first == bright.second;
  if (!squares.tags()) return {{1, white ? cell : cell + Cell{1, 0}}};
  const Cell black = white ? cell + Cell{1, 0} : cell;
  std::vector<Lines> list;
  for (const Cell& first : {black, black + Cell{1, 1}}) {
    const Lines lines{squares.gap, first, true};
    // Gaps as wide as tags tell nothing, and perspective makes a third of difference.
    if (tags_over_gaps(lattice, lines) > std::min(1.0, 0.7 / squares.gap)) list.push_back(lines);
  }
  return list;
}

}  // namespace ca2
