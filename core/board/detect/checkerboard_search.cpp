#include "core/board/detect/checkerboard_search.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/board/detect/lattice.h"

namespace ca2 {
namespace {

// Pieces of chessboard looked at: bounds the time on tiles and keyboards.
constexpr std::size_t most_pieces = 8;

/// The cells a lattice covers.
struct Extent {
  Cell low;
  Cell high;  ///< inclusive

  int width() const { return high.first - low.first + 1; }
  int height() const { return high.second - low.second + 1; }
};

Extent extent_of(const Lattice& lattice) {
  Extent extent{lattice.begin()->first, lattice.begin()->first};
  for (const auto& [cell, node] : lattice) {
    extent.low = {std::min(extent.low.first, cell.first), std::min(extent.low.second, cell.second)};
    extent.high = {std::max(extent.high.first, cell.first), std::max(extent.high.second, cell.second)};
  }
  return extent;
}

/// The cells of a lattice with low <= cell < low + size.
Lattice cut(const Lattice& lattice, const Cell& low, int width, int height) {
  Lattice part;
  for (const auto& [cell, node] : lattice) {
    const int i = cell.first - low.first;
    const int j = cell.second - low.second;
    if (i >= 0 && j >= 0 && i < width && j < height) part[cell] = node;
  }
  return part;
}

/// How many corners the line of `length` cells from `cell` along `axis` has.
int count_line(const Lattice& lattice, const Cell& cell, const Cell& axis, int length) {
  int count = 0;
  for (int k = 0; k < length; ++k) {
    count += static_cast<int>(lattice.count({cell.first + k * axis.first, cell.second + k * axis.second}));
  }
  return count;
}

/// Is each corner near the middle of its neighbours to both sides? Perspective and lenses bend a line of
/// squares less than this; a lattice that swallowed something else does not pass.
bool smooth(const Lattice& lattice) {
  for (const auto& [cell, node] : lattice) {
    for (const Cell& axis : {Cell{1, 0}, Cell{0, 1}}) {
      const auto before = lattice.find({cell.first - axis.first, cell.second - axis.second});
      const auto after = lattice.find({cell.first + axis.first, cell.second + axis.second});
      if (before == lattice.end() || after == lattice.end()) continue;
      const Eigen::Vector2d& a = before->second.saddle.pixel;
      const Eigen::Vector2d& b = after->second.saddle.pixel;
      const double off = (node.saddle.pixel - 0.5 * (a + b)).norm();
      if (off > 0.12 * (b - a).norm() + 0.5) return false;
    }
  }
  return true;
}

/// The part of a lattice that is width x height corners, all there, with none of the lines beside it more
/// than half full: those would make it a piece of a larger chessboard. What touches a board may continue it
/// by chance here and there.
std::optional<Lattice> window_of(const Lattice& lattice, int width, int height) {
  const Extent e = extent_of(lattice);
  for (int y = e.low.second; y + height - 1 <= e.high.second; ++y) {
    for (int x = e.low.first; x + width - 1 <= e.high.first; ++x) {
      const Lattice part = cut(lattice, {x, y}, width, height);
      if (part.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) continue;
      const bool alone = 2 * count_line(lattice, {x - 1, y}, {0, 1}, height) <= height &&
                         2 * count_line(lattice, {x + width, y}, {0, 1}, height) <= height &&
                         2 * count_line(lattice, {x, y - 1}, {1, 0}, width) <= width &&
                         2 * count_line(lattice, {x, y + height}, {1, 0}, width) <= width;
      if (alone && smooth(part)) return part;
    }
  }
  return std::nullopt;
}

/// One way to lay columns x rows over the lattice: corner (c, r) is cell origin + c * right + r * down.
struct Placement {
  Cell origin;
  Cell right;
  Cell down;

  Cell cell(int c, int r) const {
    return {origin.first + c * right.first + r * down.first,
            origin.second + c * right.second + r * down.second};
  }
};

/// The placements that are not mirrored, of the up to four quarter turns.
std::vector<Placement> placements(const Lattice& lattice, int columns, int rows) {
  const Extent e = extent_of(lattice);
  std::vector<Placement> result;
  const auto pixel = [&](const Cell& cell) { return lattice.at(cell).saddle.pixel; };
  const Cell corners[] = {e.low, {e.high.first, e.low.second}, e.high, {e.low.first, e.high.second}};
  const Cell along[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  // Going round the lattice's cells one way: corner k, with the next side as the rows' direction.
  for (int turn : {1, 3}) {
    for (int k = 0; k < 4; ++k) {
      const Cell right = turn == 1 ? along[k] : along[(k + 1) % 4];
      const Cell down = turn == 1 ? along[(k + 1) % 4] : along[k];
      if ((right.first != 0 ? e.width() : e.height()) != columns) continue;
      const Placement placement{corners[k], right, down};
      const Eigen::Vector2d x = pixel(placement.cell(columns - 1, 0)) - pixel(placement.cell(0, 0));
      const Eigen::Vector2d y = pixel(placement.cell(0, rows - 1)) - pixel(placement.cell(0, 0));
      // Picture and board both have x right and y down: a positive cross product, or it is a mirror image.
      if (x.x() * y.y() - x.y() * y.x() > 0) result.push_back(placement);
    }
  }
  return result;
}

/// Is the square beyond a placement's first corner, away from the board's middle, black?
bool first_square_black(const Lattice& lattice, const Placement& placement) {
  const Node& node = lattice.at(placement.origin);
  const auto slot_of = [&](const Cell& step) {
    return static_cast<int>(std::find(node.step.begin(), node.step.end(), step) - node.step.begin());
  };
  return bright_slot(slot_of(placement.right)) != slot_of(placement.down);
}

/// The placement that makes the top-left square black, or of two equals the one whose x points right.
const Placement& choose(const std::vector<Placement>& candidates, const Lattice& lattice, int columns) {
  const auto rank = [&](const Placement& p) {
    const Eigen::Vector2d x =
        lattice.at(p.cell(columns - 1, 0)).saddle.pixel - lattice.at(p.origin).saddle.pixel;
    return std::pair(first_square_black(lattice, p), x.x());
  };
  return *std::max_element(candidates.begin(), candidates.end(),
                           [&](const Placement& a, const Placement& b) { return rank(a) < rank(b); });
}

}  // namespace

std::vector<Corner> find_checkerboard(int columns, int rows, const Image& grey8) {
  if (grey8.empty() || columns < 3 || rows < 3) return {};
  const std::vector<SaddleLevel> levels = saddle_levels(grey8);
  const std::vector<Saddle> saddles = strongest_saddles(levels);
  const auto links = link_neighbours(levels, saddles, {});
  const auto wanted = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  // A larger chessboard is another one: no need to follow it to its end.
  const std::size_t most = 2 * wanted + 40;
  for (Lattice& piece :
       connected_lattices(saddles, links, std::max<std::size_t>(4, wanted / 6), most_pieces)) {
    grow(levels, piece, most, {});
    if (piece.size() < wanted || piece.size() > most) continue;
    std::optional<Lattice> lattice = window_of(piece, columns, rows);
    if (!lattice && columns != rows) lattice = window_of(piece, rows, columns);
    if (!lattice) continue;
    const std::vector<Placement> candidates = placements(*lattice, columns, rows);
    if (candidates.empty()) continue;
    const Placement& placement = choose(candidates, *lattice, columns);
    std::vector<Corner> corners;
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        const Node& node = lattice->at(placement.cell(c, r));
        corners.push_back(
            {static_cast<int>(corners.size()), node.saddle.pixel, Eigen::Matrix2d::Identity() * 0.04});
      }
    }
    return corners;
  }
  return {};
}

}  // namespace ca2
