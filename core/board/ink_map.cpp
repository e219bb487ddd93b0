#include "core/board/ink_map.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

constexpr double cells_along = 160;  // the longer side: a ChArUco's bits are two of them wide

/// A place along a side: the cell it cuts, and how much of it is before.
struct Cut {
  int cell;
  double part;
};

/// `size` cells; what is beside them, NaN included, is at their ends.
Cut cut(double place, int size) {
  const double inside = place > 0 ? std::min(place, static_cast<double>(size)) : 0;
  const int cell = std::min(static_cast<int>(inside), size - 1);
  return {cell, inside - cell};
}

}  // namespace

InkMap::InkMap(const Board& board) {
  const Eigen::Vector2d size = board.type->pattern_size(board);
  corner_ = -0.5 * size;
  // Whole cells along both sides, so that a print that half a turn leaves alone has a map of which it does.
  columns_ = static_cast<int>(std::ceil(cells_along * size.x() / size.maxCoeff()));
  rows_ = static_cast<int>(std::ceil(cells_along * size.y() / size.maxCoeff()));
  cell_ = size.cwiseQuotient(Eigen::Vector2d(columns_, rows_));
  const int stride = columns_ + 1;
  sums_.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows_ + 1), 0);
  for (int row = 0; row < rows_; ++row) {
    std::int32_t in_row = 0;
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d middle = corner_ + cell_.cwiseProduct(Eigen::Vector2d(column + 0.5, row + 0.5));
      in_row += board.type->black(board, middle) ? 1 : 0;
      const auto below = static_cast<std::size_t>((row + 1) * stride + column + 1);
      sums_[below] = sums_[below - static_cast<std::size_t>(stride)] + in_row;
    }
  }
}

double InkMap::share(const Eigen::Vector2d& p, double width) const {
  const Eigen::Vector2d middle = (p - corner_).cwiseQuotient(cell_);
  const Eigen::Vector2d half = (0.5 * width * cell_.cwiseInverse()).cwiseMax(0.5);
  const Cut left = cut(middle.x() - half.x(), columns_), right = cut(middle.x() + half.x(), columns_);
  const Cut top = cut(middle.y() - half.y(), rows_), bottom = cut(middle.y() + half.y(), rows_);
  // Black above a row of cells, between left and right.
  const auto above = [&](int row) {
    const std::int32_t* sums = &sums_[static_cast<std::size_t>(row * (columns_ + 1))];
    return (sums[right.cell] - sums[left.cell]) + right.part * (sums[right.cell + 1] - sums[right.cell]) -
           left.part * (sums[left.cell + 1] - sums[left.cell]);
  };
  const auto above_cut = [&](const Cut& at) {
    return (1 - at.part) * above(at.cell) + at.part * above(at.cell + 1);
  };
  return (above_cut(bottom) - above_cut(top)) / (4 * half.prod());
}

}  // namespace ca2
