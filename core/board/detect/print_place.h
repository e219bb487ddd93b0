/// @file Where on a printed board a piece of chessboard lies.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "core/board/board.h"
#include "core/board/detect/print_piece.h"
#include "core/board/detect/print_search.h"

namespace ca2 {

/// Corner of the board = cell after `turns` quarter turns, from x to y, + offset.
struct PrintPlace {
  int turns = 0;
  Cell offset;
  int own_turns = 0;  ///< of every print in its square: generators of tags differ

  Cell corner(const Cell& cell) const;
};

/// The print of every square of a board.
class PrintMap {
 public:
  /// Fields of a square without their mean: black ones below 0. Nothing for squares without print.
  using Fields = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;

  PrintMap(const Board& board, const SquarePrint& print);

  /// The one place in which the picture shows the print in and round a piece; nothing where none does, or
  /// several.
  std::optional<PrintPlace> place_of(const PrintPiece& piece, const Image& grey8) const;

  /// Of a piece: a larger chessboard is another one.
  std::size_t most_corners() const;

  int corner_columns() const { return columns_ - 1; }
  bool on_board(const Cell& corner) const {
    return corner.first >= 0 && corner.second >= 0 && corner.first < columns_ - 1 &&
           corner.second < rows_ - 1;
  }

 private:
  struct Match {
    double sigmas = 0;       ///< of the correlation, above chance
    double correlation = 0;  ///< -1..1
  };
  struct Seen {
    Cell cell;
    Fields fields;
  };

  std::vector<Seen> seen_in(const PrintPiece& piece, const Image& grey8) const;
  Match match(const std::vector<Seen>& seen, const PrintPlace& place) const;

  int columns_;  ///< of squares, those in a grid's gaps and round it too
  int rows_;
  SquarePrint print_;
  std::array<std::vector<Fields>, 4> printed_;  ///< as a piece shows it that is turned so
};

}  // namespace ca2
