/// @file A board's corners looked for one by one, each where it should be.
#pragma once

#include <span>
#include <vector>

#include "core/board/board.h"
#include "core/board/detect/saddle_pyramid.h"
#include "core/board/refine/neighbourhood.h"

namespace ca2 {

/// Saddles of a picture near places where a board's corners are expected, with black and white round them as
/// the board prints it.
class CornerSearch {
 public:
  /// Both are referred to.
  CornerSearch(const Board& board, const Image& grey8);

  /// Those of `expected` that are there, each within `reach` times the distance to its nearest neighbour.
  std::vector<Corner> find(std::span<const Corner> expected, double reach) const;

  /// Adds the neighbours of those in `corners` that are there. How many were added.
  std::size_t grow(std::vector<Corner>& corners, double reach) const;

  /// The corners, and after them where the board's others should be that are one step of the pitch from
  /// those.
  std::vector<Corner> with_neighbours(const std::vector<Corner>& found) const;

 private:
  std::vector<Corner> find_from(std::span<const Corner> expected, std::size_t first, double reach) const;
  std::optional<Eigen::Vector2d> corner_near(const Corner& expected, const Neighbourhood& lattice,
                                             double reach_in_spacings) const;
  bool right_sense(int id, const Neighbourhood& lattice, const Eigen::Vector2d& bright) const;

  const Board& board_;
  const Image& grey8_;
  std::vector<Eigen::Vector2d> points_;
  double pitch_;
  Rings rings_;  ///< where there are markers they leave little room round the corners
};

}  // namespace ca2
