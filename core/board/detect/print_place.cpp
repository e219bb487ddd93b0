#include "core/board/detect/print_place.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/board/detect/grey_at.h"

namespace ca2 {
namespace {

constexpr double least_inside = 0.9;  // of a piece's corners on the board: the rest is what it swallowed
// Correlation of picture and print. By chance it is one over the root of the number of fields.
constexpr double least_correlation = 0.25;
constexpr double least_sigmas = 7;
constexpr double least_lead = 3;  // sigmas before the next best place

Cell turned(Cell cell, int turns) {
  for (; turns > 0; --turns) cell = {-cell.second, cell.first};
  return cell;
}

PrintMap::Fields turned_back(PrintMap::Fields fields, int turns) {
  for (; turns > 0; --turns) fields = fields.transpose().colwise().reverse().eval();
  return fields;
}

void remove_mean(PrintMap::Fields& fields) {
  fields.array() -= fields.mean();
}

/// Along a square's side, 0..1: the middle of a field.
double field_middle(const SquarePrint& print, int field) {
  return 0.5 + print.share * ((field + 0.5) / print.cells - 0.5);
}

}  // namespace

Cell PrintPlace::corner(const Cell& cell) const {
  return turned(cell, turns) + offset;
}

PrintMap::PrintMap(const Board& board, const SquarePrint& print)
    : columns_(print.tags() ? 2 * board.columns + 1 : board.columns),
      rows_(print.tags() ? 2 * board.rows + 1 : board.rows),
      print_(print) {
  const Lines lines = print.tags() ? Lines{print.gap, {1, 1}, true} : Lines{1, {1, 0}};
  const Eigen::Vector2d middle = 0.5 * (lines.place({0, 0}) + lines.place({columns_, rows_}));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      Fields fields;
      if (lines.printed({column, row})) {
        fields.resize(print.cells, print.cells);
        for (int j = 0; j < print.cells; ++j) {
          for (int i = 0; i < print.cells; ++i) {
            const Eigen::Vector2d at = lines.place({column, row}) - middle +
                                       Eigen::Vector2d(field_middle(print, i), field_middle(print, j));
            fields(j, i) = board.type->black(board, at * board.square) ? 0 : 1;
          }
        }
        remove_mean(fields);
      }
      for (int turns = 0; turns < 4; ++turns)
        printed_[static_cast<std::size_t>(turns)].push_back(turned_back(fields, turns));
    }
  }
}

std::vector<PrintMap::Seen> PrintMap::seen_in(const PrintPiece& piece, const Image& grey8) const {
  std::vector<Seen> seen;
  for (const Cell& cell : printed_squares(piece)) {
    const auto shown = print_square(piece, cell);
    if (!shown) continue;
    Seen square{cell, Fields(print_.cells, print_.cells)};
    bool inside = true;
    for (int j = 0; j < print_.cells && inside; ++j) {
      for (int i = 0; i < print_.cells && inside; ++i) {
        const auto grey = grey_at(grey8, shown->pixel(field_middle(print_, i), field_middle(print_, j)));
        inside = grey.has_value();
        square.fields(j, i) = static_cast<float>(grey.value_or(0));
      }
    }
    if (!inside) continue;
    remove_mean(square.fields);
    seen.push_back(std::move(square));
  }
  return seen;
}

PrintMap::Match PrintMap::match(const std::vector<Seen>& seen, const PrintPlace& place) const {
  double product = 0, seen_squares = 0, printed_squares = 0;
  int count = 0;
  for (const Seen& square : seen) {
    // The square's first corner after the turn is another of its four.
    const Cell a = place.corner(square.cell), b = place.corner(square.cell + Cell{1, 1});
    const int column = std::min(a.first, b.first) + 1, row = std::min(a.second, b.second) + 1;
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) continue;
    const Fields& fields = printed_[static_cast<std::size_t>((place.turns + place.own_turns) % 4)]
                                   [static_cast<std::size_t>(row * columns_ + column)];
    if (fields.size() == 0) return {};
    product += square.fields.cwiseProduct(fields).sum();
    seen_squares += square.fields.squaredNorm();
    printed_squares += fields.squaredNorm();
    count += static_cast<int>(fields.size());
  }
  if (!(seen_squares > 0 && printed_squares > 0)) return {};
  const double correlation = product / std::sqrt(seen_squares * printed_squares);
  return {correlation * std::sqrt(count), correlation};
}

std::size_t PrintMap::most_corners() const {
  return static_cast<std::size_t>((columns_ - 1) * (rows_ - 1) / least_inside);
}

std::optional<PrintPlace> PrintMap::place_of(const PrintPiece& piece, const Image& grey8) const {
  if (piece.corners.size() > most_corners()) return std::nullopt;
  const auto size = static_cast<double>(piece.corners.size());
  const std::vector<Seen> seen = seen_in(piece, grey8);
  std::optional<PrintPlace> best;
  Match best_match;
  double second = 0;
  for (int turns = 0; turns < 4; ++turns) {
    Cell low{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
    Cell high{std::numeric_limits<int>::min(), std::numeric_limits<int>::min()};
    for (const auto& [cell, pixel] : piece.corners) {
      const Cell at = turned(cell, turns);
      low = {std::min(low.first, at.first), std::min(low.second, at.second)};
      high = {std::max(high.first, at.first), std::max(high.second, at.second)};
    }
    for (int y = -high.second; y <= rows_ - 2 - low.second; ++y) {
      for (int x = -high.first; x <= columns_ - 2 - low.first; ++x) {
        PrintPlace place{turns, {x, y}};
        const auto inside = std::count_if(piece.corners.begin(), piece.corners.end(), [&](const auto& entry) {
          return on_board(place.corner(entry.first));
        });
        if (static_cast<double>(inside) < least_inside * size) continue;
        for (; place.own_turns < (print_.tags() ? 4 : 1); ++place.own_turns) {
          const Match found = match(seen, place);
          if (found.sigmas > best_match.sigmas) {
            second = best_match.sigmas;
            best_match = found;
            best = place;
          } else {
            second = std::max(second, found.sigmas);
          }
        }
      }
    }
  }
  if (best_match.correlation < least_correlation || best_match.sigmas < least_sigmas ||
      best_match.sigmas < second + least_lead) {
    return std::nullopt;
  }
  return best;
}

}  // namespace ca2
