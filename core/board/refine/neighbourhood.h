/// @file How the board's lattice lies round each of its corners in a picture.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// The picture near a corner: pixel = corner + board x * along[0] + board y * along[1] to first order, with
/// the board's x and y in units of the pitch.
struct Neighbourhood {
  Eigen::Vector2d along[2] = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};  ///< px per pitch
  double reach[2] = {0, 0};      ///< px to the nearer neighbour on each axis
  double curvature[2] = {0, 0};  ///< 1/px, of the lines through the corner, to the left of along
};

/// The least distance between neighbouring lines of corners of a board, m. The lines are parallel to the
/// board's axes and need not be evenly spaced.
double corner_pitch(const std::vector<Eigen::Vector2d>& board_points);

/// One per corner; nothing where an axis has no neighbour.
std::vector<std::optional<Neighbourhood>> neighbourhoods(const std::vector<Eigen::Vector2d>& board_points,
                                                         std::span<const Corner> corners);

}  // namespace ca2
