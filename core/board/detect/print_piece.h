/// @file A piece of chessboard whose squares are to be read: a ChArUco's white ones, or an AprilGrid's tags.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "core/board/detect/lattice.h"

namespace ca2 {

/// Corners by right-handed cells: y turns from x as in the picture. The square of a cell lies beyond it along
/// both axes.
struct PrintPiece {
  std::map<Cell, Eigen::Vector2d> corners;  ///< px
  Lines lines;
};

PrintPiece print_piece(const Lattice& lattice, const Lines& lines);

/// Where the points of one square, 0..1 along its sides, are in the picture.
class PrintSquare {
 public:
  using Fit = Eigen::Matrix<double, 14, 1>;

  PrintSquare(const Eigen::Vector2d& origin, const Fit& fit) : origin_(origin), fit_(fit) {}
  Eigen::Vector2d pixel(double x, double y) const;

 private:
  Eigen::Vector2d origin_;
  /// From the square's middle, x and y: there, by u, by v, by their squares and product; then how both vanish
  /// along u and v.
  Fit fit_;
};

/// The square of a cell, by the corners nearby: it need not have all four of its own. A board of few corners
/// has most of its squares round them.
std::optional<PrintSquare> print_square(const PrintPiece& piece, const Cell& cell);

/// The printed squares that touch a piece's corners.
std::vector<Cell> printed_squares(const PrintPiece& piece);

}  // namespace ca2
