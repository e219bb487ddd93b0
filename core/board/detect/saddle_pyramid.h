/// @file Where in a picture four fields meet like on a chessboard, in one bounded pass per scale.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/types/image.h"

namespace ca2 {

/// One scale of a picture, smoothed by a binomial of sigma 1 px of its own.
struct SaddleLevel {
  int width = 0;
  int height = 0;
  double scale = 1;                  ///< px of the picture per px of this level
  std::vector<std::int16_t> smooth;  ///< 16 times the grey value, rows from the top

  int at(int x, int y) const { return smooth[static_cast<std::size_t>(y) * width + x]; }
  /// Bilinear grey value 0..255 at a place of this level, 0 <= x < width - 1, 0 <= y < height - 1.
  double interpolate(double x, double y) const;
  /// Bilinear grey value 0..255 at a pixel of the picture; the rim's outside it.
  double grey(const Eigen::Vector2d& pixel) const;
  Eigen::Vector2d to_level(const Eigen::Vector2d& pixel) const {
    return ((pixel.array() + 0.5) / scale - 0.5).matrix();
  }
  Eigen::Vector2d to_picture(const Eigen::Vector2d& p) const {
    return ((p.array() + 0.5) * scale - 0.5).matrix();
  }
};

/// A saddle of the grey values where two edges cross: between +e0 and +e1 (and opposite) it is bright,
/// between +e0 and -e1 dark.
struct Saddle {
  Eigen::Vector2d pixel;  ///< px of the picture
  Eigen::Vector2d e0;     ///< unit
  Eigen::Vector2d e1;     ///< unit
  double strength = 0;    ///< sqrt(-det of the Hessian), grey values per square px of its level
  int level = 0;
};

/// The levels on which saddles are looked for: full resolution, a half, a quarter.
std::vector<SaddleLevel> saddle_levels(const Image& grey8);

/// The saddle that Newton's iteration reaches from `pixel`, if there is one within 2 px of the level.
std::optional<Saddle> saddle_near(const std::vector<SaddleLevel>& levels, int level,
                                  const Eigen::Vector2d& pixel);

/// The strongest saddles of all levels, each place once (on its finest level), strongest first. Their
/// number is bounded, whatever the picture shows.
std::vector<Saddle> strongest_saddles(const std::vector<SaddleLevel>& levels);

}  // namespace ca2
