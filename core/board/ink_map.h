/// @file How much of a spot on a board is printed black.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// The print as a table of sums, so that a spot costs the same whatever its size.
class InkMap {
 public:
  explicit InkMap(const Board& board);

  /// Share of black, 0 .. 1, in a square spot of `width` [m] about `p` (board frame, m), its sides along the
  /// board's. What is beside the print is white.
  double share(const Eigen::Vector2d& p, double width) const;
  /// The same of `count` spots, a multiple of four, four at a time: x, y and width [m] to `shares`.
  void shares(const double* x, const double* y, const double* width, Eigen::Index count,
              double* shares) const;

 private:
  Eigen::Vector2d corner_;  ///< of the first cell, m
  Eigen::Vector2d cell_;    ///< m, along x and y
  int columns_ = 0, rows_ = 0;
  std::vector<float> sums_;  ///< black cells above and to the left: [(rows + 1) x (columns + 1)]; exact
};

}  // namespace ca2
