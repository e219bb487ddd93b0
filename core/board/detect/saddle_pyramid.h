/// @file Where in a picture four fields meet like on a chessboard, in one bounded pass per scale.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/board/detect/saddle_level.h"

namespace ca2 {

/// A saddle of the grey values where two edges cross: between +e0 and +e1 (and opposite) it is bright,
/// between +e0 and -e1 dark.
struct Saddle {
  Eigen::Vector2d pixel;  ///< px of the picture
  Eigen::Vector2d e0;     ///< unit
  Eigen::Vector2d e1;     ///< unit
  double strength = 0;    ///< sqrt(-det of the Hessian), grey values per square px of its level
  int level = 0;
};

/// How near to a saddle its four fields are looked for: `small` also in the gap between a corner and the
/// marker in its white square, which on texture takes a third more time.
enum class Rings { usual, small };

/// The saddle that Newton's iteration reaches from `pixel`, if there is one within 2 px of the level.
std::optional<Saddle> saddle_near(const std::vector<SaddleLevel>& levels, int level,
                                  const Eigen::Vector2d& pixel, Rings rings = Rings::usual);

/// The strongest saddles of all levels, each place once (on its finest level), strongest first. Their
/// number is bounded, whatever the picture shows.
std::vector<Saddle> strongest_saddles(const std::vector<SaddleLevel>& levels, Rings rings = Rings::usual);

}  // namespace ca2
