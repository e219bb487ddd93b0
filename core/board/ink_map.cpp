#include "core/board/ink_map.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

constexpr double cells_along = 160;  // the longer side: a ChArUco's bits are two of them wide

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
    std::uint32_t in_row = 0;
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d middle = corner_ + cell_.cwiseProduct(Eigen::Vector2d(column + 0.5, row + 0.5));
      in_row += board.type->black(board, middle) ? 1 : 0;
      const auto below = static_cast<std::size_t>((row + 1) * stride + column + 1);
      sums_[below] = sums_[below - static_cast<std::size_t>(stride)] + in_row;
    }
  }
}

double InkMap::black_before(double column, double row) const {
  // Inside the table, NaN included.
  const double c = column > 0 ? std::min(column, static_cast<double>(columns_)) : 0;
  const double r = row > 0 ? std::min(row, static_cast<double>(rows_)) : 0;
  const int i = std::min(static_cast<int>(c), columns_ - 1), j = std::min(static_cast<int>(r), rows_ - 1);
  const double u = c - i, v = r - j;
  const auto at = [&](int x, int y) {
    return static_cast<double>(sums_[static_cast<std::size_t>(y * (columns_ + 1) + x)]);
  };
  return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
         v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

double InkMap::share(const Eigen::Vector2d& p, double width) const {
  const Eigen::Vector2d middle = (p - corner_).cwiseQuotient(cell_);
  const Eigen::Vector2d half = (0.5 * width * cell_.cwiseInverse()).cwiseMax(0.5);
  const double left = middle.x() - half.x(), right = middle.x() + half.x();
  const double top = middle.y() - half.y(), bottom = middle.y() + half.y();
  const double black = black_before(right, bottom) - black_before(left, bottom) - black_before(right, top) +
                       black_before(left, top);
  return black / (4 * half.prod());
}

}  // namespace ca2
