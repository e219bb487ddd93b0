/// @file The physical plate that carries the print: flat, or bent by a few millimetres.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/board/board.h"

namespace ca2 {

/// A rectangle in the board frame, bent to a parabolic cylinder about the board's y axis.
struct Plate {
  Outline outline;
  double bend = 0;  ///< m: sagitta from the middle to the left and right edges; > 0: the middle bulges to the
                    ///< viewer. The mean height is zero, so that z = 0 stays the plane of best fit.

  /// Height of the surface over the board's plane (along z, away from the viewer), m.
  double height(const Eigen::Vector2d& p_board) const;
  /// Is the place on the plate, at least `rim` m inside its edges?
  bool contains(const Eigen::Vector2d& p_board, double rim = 0) const;

  /// Distance (of any sign) along the unit `direction` from `origin`, both in the board frame, to the surface
  /// continued beyond the plate's edges. Exact also for the bent plate.
  std::optional<double> meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// Distance along the unit `direction` to the plate itself; only ahead.
  std::optional<double> intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
};

}  // namespace ca2
