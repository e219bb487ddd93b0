#include "core/board/detect/print_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>

#include "core/board/detect/lattice.h"
#include "core/board/detect/saddle_pyramid.h"

namespace ca2 {
namespace {

constexpr std::size_t least_corners = 6;
constexpr std::size_t most_pieces = 8;  // bounds the time on texture
constexpr double least_inside = 0.9;    // of a piece's corners on the board: the rest is what it swallowed
// Correlation of picture and print. By chance it is one over the root of the number of cells.
constexpr double least_correlation = 0.25;
constexpr double least_sigmas = 7;
constexpr double least_lead = 3;  // sigmas before the next best place

/// The pixels of a piece's corners by right-handed cell: y turns from x as in the picture.
using Pixels = std::map<Cell, Eigen::Vector2d>;

Pixels right_handed(const Lattice& lattice) {
  double sense = 0;
  for (const auto& [cell, node] : lattice) {
    const auto right = lattice.find({cell.first + 1, cell.second});
    const auto down = lattice.find({cell.first, cell.second + 1});
    if (right == lattice.end() || down == lattice.end()) continue;
    const Eigen::Vector2d x = right->second.saddle.pixel - node.saddle.pixel;
    const Eigen::Vector2d y = down->second.saddle.pixel - node.saddle.pixel;
    sense += x.x() * y.y() - x.y() * y.x() > 0 ? 1 : -1;
  }
  Pixels pixels;
  for (const auto& [cell, node] : lattice) {
    pixels[{cell.first, sense < 0 ? -cell.second : cell.second}] = node.saddle.pixel;
  }
  return pixels;
}

double grey_at(const Image& image, const Eigen::Vector2d& p) {
  const double px = std::clamp(p.x(), 0.0, image.width - 1.001);
  const double py = std::clamp(p.y(), 0.0, image.height - 1.001);
  const int x = static_cast<int>(px), y = static_cast<int>(py);
  const std::uint8_t* at = image.bytes.data() + static_cast<std::size_t>(y) * image.width + x;
  const double a = px - x, b = py - y;
  return (1 - b) * ((1 - a) * at[0] + a * at[1]) + b * ((1 - a) * at[image.width] + a * at[image.width + 1]);
}

void remove_mean(Eigen::MatrixXd& values) {
  values.array() -= values.mean();
}

/// What the picture shows in the squares of a piece, by the cell of their first corner, without the mean.
std::map<Cell, Eigen::MatrixXd> seen_squares(const Pixels& pixels, const SquarePrint& print,
                                             const Image& grey8) {
  std::map<Cell, Eigen::MatrixXd> squares;
  for (const auto& [cell, a] : pixels) {
    const auto b = pixels.find({cell.first + 1, cell.second});
    const auto c = pixels.find({cell.first, cell.second + 1});
    const auto d = pixels.find({cell.first + 1, cell.second + 1});
    if (b == pixels.end() || c == pixels.end() || d == pixels.end()) continue;
    Eigen::MatrixXd square(print.cells, print.cells);
    for (int j = 0; j < print.cells; ++j) {
      for (int i = 0; i < print.cells; ++i) {
        const double u = 0.5 + print.share * ((i + 0.5) / print.cells - 0.5);
        const double v = 0.5 + print.share * ((j + 0.5) / print.cells - 0.5);
        square(j, i) = grey_at(
            grey8, (1 - v) * ((1 - u) * a + u * b->second) + v * ((1 - u) * c->second + u * d->second));
      }
    }
    remove_mean(square);
    squares[cell] = square;
  }
  return squares;
}

/// The same as the board has it, by column and row; white is 1.
std::map<Cell, Eigen::MatrixXd> printed_squares(const Board& board, const SquarePrint& print) {
  std::map<Cell, Eigen::MatrixXd> squares;
  for (int row = 1; row + 1 < board.rows; ++row) {
    for (int column = 1; column + 1 < board.columns; ++column) {
      Eigen::MatrixXd square(print.cells, print.cells);
      for (int j = 0; j < print.cells; ++j) {
        for (int i = 0; i < print.cells; ++i) {
          const Eigen::Vector2d at(
              column - 0.5 * board.columns + 0.5 + print.share * ((i + 0.5) / print.cells - 0.5),
              row - 0.5 * board.rows + 0.5 + print.share * ((j + 0.5) / print.cells - 0.5));
          square(j, i) = board.type->black(board, at * board.square) ? 0 : 1;
        }
      }
      remove_mean(square);
      squares[{column, row}] = square;
    }
  }
  return squares;
}

/// A cell after `turns` quarter turns, from x to y.
Cell turned(Cell cell, int turns) {
  for (; turns > 0; --turns) cell = {-cell.second, cell.first};
  return cell;
}

Eigen::MatrixXd turned(Eigen::MatrixXd square, int turns) {
  for (; turns > 0; --turns) square = square.transpose().rowwise().reverse().eval();
  return square;
}

/// Where a piece lies on the board: corner = turned(cell, turns) + offset.
struct Place {
  int turns = 0;
  Cell offset;
  double sigmas = 0;       ///< of the correlation, above chance
  double correlation = 0;  ///< -1..1

  Cell corner(const Cell& cell) const {
    const Cell at = turned(cell, turns);
    return {at.first + offset.first, at.second + offset.second};
  }
};

bool on_board(const Board& board, const Cell& corner) {
  return corner.first >= 0 && corner.second >= 0 && corner.first < board.columns - 1 &&
         corner.second < board.rows - 1;
}

void judge(const std::map<Cell, Eigen::MatrixXd>& seen, const std::map<Cell, Eigen::MatrixXd>& printed,
           Place& place) {
  double product = 0, seen_squares = 0, printed_squares = 0;
  int count = 0;
  for (const auto& [cell, square] : seen) {
    // The square's first corner after the turn is another of its four.
    const Cell a = place.corner(cell), b = place.corner({cell.first + 1, cell.second + 1});
    const auto there = printed.find({std::min(a.first, b.first) + 1, std::min(a.second, b.second) + 1});
    if (there == printed.end() || there->second.squaredNorm() == 0) continue;
    product += turned(square, place.turns).cwiseProduct(there->second).sum();
    seen_squares += square.squaredNorm();
    printed_squares += there->second.squaredNorm();
    count += static_cast<int>(square.size());
  }
  if (!(seen_squares > 0 && printed_squares > 0)) return;
  place.correlation = product / std::sqrt(seen_squares * printed_squares);
  place.sigmas = place.correlation * std::sqrt(count);
}

std::optional<Place> place_of(const Board& board, const Pixels& pixels,
                              const std::map<Cell, Eigen::MatrixXd>& seen,
                              const std::map<Cell, Eigen::MatrixXd>& printed) {
  std::optional<Place> best;
  double second = 0;
  for (int turns = 0; turns < 4; ++turns) {
    Cell low{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
    Cell high{std::numeric_limits<int>::min(), std::numeric_limits<int>::min()};
    for (const auto& [cell, pixel] : pixels) {
      const Cell at = turned(cell, turns);
      low = {std::min(low.first, at.first), std::min(low.second, at.second)};
      high = {std::max(high.first, at.first), std::max(high.second, at.second)};
    }
    for (int y = -high.second; y <= board.rows - 2 - low.second; ++y) {
      for (int x = -high.first; x <= board.columns - 2 - low.first; ++x) {
        Place place{turns, {x, y}, 0, 0};
        const auto inside = std::count_if(pixels.begin(), pixels.end(), [&](const auto& entry) {
          return on_board(board, place.corner(entry.first));
        });
        if (static_cast<double>(inside) < least_inside * static_cast<double>(pixels.size())) continue;
        judge(seen, printed, place);
        if (!best || place.sigmas > best->sigmas) {
          if (best) second = best->sigmas;
          best = place;
        } else {
          second = std::max(second, place.sigmas);
        }
      }
    }
  }
  if (!best || best->correlation < least_correlation || best->sigmas < least_sigmas ||
      best->sigmas < second + least_lead) {
    return std::nullopt;
  }
  return best;
}

/// The corners of a piece, where the print tells its place.
std::vector<Corner> placed_corners(const Board& board, const SquarePrint& print, const Image& grey8,
                                   const std::map<Cell, Eigen::MatrixXd>& printed, const Lattice& piece) {
  const Pixels pixels = right_handed(piece);
  const auto place = place_of(board, pixels, seen_squares(pixels, print, grey8), printed);
  std::vector<Corner> corners;
  if (!place) return corners;
  for (const auto& [cell, pixel] : pixels) {
    const Cell at = place->corner(cell);
    if (!on_board(board, at)) continue;
    corners.push_back(
        {at.second * (board.columns - 1) + at.first, pixel, Eigen::Matrix2d::Identity() * 0.04});
  }
  return corners;
}

}  // namespace

std::vector<Corner> find_by_print(const Board& board, const SquarePrint& print, const Image& grey8) {
  if (grey8.empty()) return {};
  const std::vector<SaddleLevel> levels = saddle_levels(grey8);
  const std::vector<Saddle> saddles = strongest_saddles(levels, Rings::small);
  const auto printed = printed_squares(board, print);
  const auto most = static_cast<std::size_t>(2 * board.columns * board.rows + 40);
  const auto place_any = [&](std::vector<Lattice>& pieces) -> std::vector<Corner> {
    for (Lattice& piece : pieces) {
      grow(levels, piece, most, Rings::small);
      if (piece.size() < least_corners || piece.size() > most) continue;
      std::vector<Corner> corners = placed_corners(board, print, grey8, printed, piece);
      if (!corners.empty()) return corners;
    }
    return {};
  };
  std::vector<Lattice> pieces = connected_lattices(saddles, link_neighbours(levels, saddles), 4, most_pieces);
  if (std::vector<Corner> corners = place_any(pieces); !corners.empty()) return corners;
  // Squares of 10 px and less leave a board in pieces, of which none shows enough of the print.
  std::vector<Lattice> merged = merged_pieces(std::move(pieces));
  return place_any(merged);
}

}  // namespace ca2
