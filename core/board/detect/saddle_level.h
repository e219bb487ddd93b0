/// @file Scales of a picture, whole or round a place, as the search for saddles wants them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/types/image.h"

namespace ca2 {

/// One scale of a picture, or of a window in it, smoothed by a binomial of sigma 1 px of its own.
struct SaddleLevel {
  int width = 0;
  int height = 0;
  double scale = 1;                                  ///< px of the picture per px of this level
  std::vector<std::int16_t> smooth;                  ///< 16 times the grey value, rows from the top
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< px of the picture where the window begins

  int at(int x, int y) const { return smooth[static_cast<std::size_t>(y) * width + x]; }
  /// Bilinear grey value 0..255 at a place of this level, 0 <= x < width - 1, 0 <= y < height - 1.
  float interpolate(float x, float y) const {
    const int i = static_cast<int>(x);
    const int j = static_cast<int>(y);
    const float a = x - static_cast<float>(i);
    const float b = y - static_cast<float>(j);
    const std::int16_t* v = smooth.data() + static_cast<std::size_t>(j) * width + i;
    return ((1 - b) * ((1 - a) * v[0] + a * v[1]) + b * ((1 - a) * v[width] + a * v[width + 1])) / 16;
  }
  /// Bilinear grey value 0..255 at a pixel of the picture; the rim's outside it.
  double grey(const Eigen::Vector2d& pixel) const;
  Eigen::Vector2d to_level(const Eigen::Vector2d& pixel) const {
    return (((pixel - origin).array() + 0.5) / scale - 0.5).matrix();
  }
  Eigen::Vector2d to_picture(const Eigen::Vector2d& p) const {
    return ((p.array() + 0.5) * scale - 0.5).matrix() + origin;
  }
};

inline constexpr int saddle_level_count = 3;

/// The levels on which saddles are looked for: full resolution, a half, a quarter.
std::vector<SaddleLevel> saddle_levels(const Image& grey8);

/// The part of level `level` within `radius` px of that level of a pixel, with the margin the search for
/// saddles needs round it, cut off at the picture's rim. The same grey values as in saddle_levels. Empty
/// where the picture ends.
SaddleLevel saddle_window(const Image& grey8, int level, const Eigen::Vector2d& pixel, int radius);

}  // namespace ca2
