#include "core/board/ink_map.h"

#include <algorithm>
#include <cmath>

#include "core/types/four.h"
#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

constexpr double cells_along = 160;  // the longer side: a ChArUco's bits are two of them wide

using FourCells = std::int32_t __attribute__((vector_size(16)));

/// Places along a side: the cells they cut, and how much of each is before.
struct Cuts {
  FourCells cell;
  Four part;
};

/// `size` cells; what is beside them, NaN included, is at their ends.
__attribute__((always_inline)) inline void cut(const Four& place, int size, Cuts& cuts) {
  const Four end = Four{} + static_cast<double>(size);
  const FourCells last = FourCells{} + (size - 1);
  const Four positive = place > 0 ? place : Four{};
  const Four inside = positive < end ? positive : end;
  const FourCells cell = __builtin_convertvector(inside, FourCells);
  cuts.cell = cell < last ? cell : last;
  cuts.part = inside - __builtin_convertvector(cuts.cell, Four);
}

/// What is at `place` and next to it.
__attribute__((always_inline)) inline void gather(const float* table, const FourCells& place, Four& here,
                                                  Four& next) {
  for (int k = 0; k < 4; ++k) {
    here[k] = table[place[k]];
    next[k] = table[place[k] + 1];
  }
}

struct Table {
  Eigen::Vector2d corner, cell;
  int columns, rows;
  const float* sums;
};

CA2_HOT_LOOP void share_of(const Table& table, const double* x, const double* y, const double* width,
                           Eigen::Index count, double* shares) {
  const double columns_per_m = 1 / table.cell[0], rows_per_m = 1 / table.cell[1];
  const Four least = Four{} + 0.5;
  for (Eigen::Index i = 0; i < count; i += 4) {
    Four middle_x, middle_y, spot;
    load(middle_x, x + i);
    load(middle_y, y + i);
    load(spot, width + i);
    middle_x = (middle_x - table.corner[0]) / table.cell[0];
    middle_y = (middle_y - table.corner[1]) / table.cell[1];
    Four half_x = 0.5 * spot * columns_per_m, half_y = 0.5 * spot * rows_per_m;
    half_x = half_x < least ? least : half_x;
    half_y = half_y < least ? least : half_y;
    Cuts left, right, top, bottom;
    cut(middle_x - half_x, table.columns, left);
    cut(middle_x + half_x, table.columns, right);
    cut(middle_y - half_y, table.rows, top);
    cut(middle_y + half_y, table.rows, bottom);
    // Black above a row of cells, between left and right: above and below the cells that top and bottom cut.
    Four above[4];
    const FourCells rows[4] = {top.cell, top.cell + 1, bottom.cell, bottom.cell + 1};
    for (int j = 0; j < 4; ++j) {
      const FourCells row = rows[j] * (table.columns + 1);
      Four from, past_from, to, past_to;
      gather(table.sums, row + left.cell, from, past_from);
      gather(table.sums, row + right.cell, to, past_to);
      above[j] = (to - from) + right.part * (past_to - to) - left.part * (past_from - from);
    }
    const Four over = (1 - top.part) * above[0] + top.part * above[1];
    const Four under = (1 - bottom.part) * above[2] + bottom.part * above[3];
    store(shares + i, (under - over) / (4 * (half_x * half_y)));
  }
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
    float in_row = 0;
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d middle = corner_ + cell_.cwiseProduct(Eigen::Vector2d(column + 0.5, row + 0.5));
      in_row += board.type->black(board, middle) ? 1.0f : 0.0f;
      const auto below = static_cast<std::size_t>((row + 1) * stride + column + 1);
      sums_[below] = sums_[below - static_cast<std::size_t>(stride)] + in_row;
    }
  }
}

double InkMap::share(const Eigen::Vector2d& p, double width) const {
  const Eigen::Array4d x = Eigen::Array4d::Constant(p.x()), y = Eigen::Array4d::Constant(p.y());
  const Eigen::Array4d widths = Eigen::Array4d::Constant(width);
  Eigen::Array4d four;
  shares(x.data(), y.data(), widths.data(), four.size(), four.data());
  return four[0];
}

void InkMap::shares(const double* x, const double* y, const double* width, Eigen::Index count,
                    double* shares) const {
  share_of({corner_, cell_, columns_, rows_, sums_.data()}, x, y, width, count, shares);
}

}  // namespace ca2
