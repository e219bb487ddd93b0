/// @file A picture between its pixels.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/types/image.h"

namespace ca2 {

/// The 8-bit grey picture at a place between pixels; nothing outside of it.
inline std::optional<double> grey_at(const Image& image, const Eigen::Vector2d& p) {
  // Before the casts: far outside they would be undefined.
  if (!(p.x() >= 0 && p.y() >= 0 && p.x() < image.width - 1 && p.y() < image.height - 1)) return std::nullopt;
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const std::uint8_t* at =
      image.bytes.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + x;
  const double a = p.x() - x, b = p.y() - y;
  return (1 - b) * ((1 - a) * at[0] + a * at[1]) + b * ((1 - a) * at[image.width] + a * at[image.width + 1]);
}

}  // namespace ca2
