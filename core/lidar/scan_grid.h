/// @file Rings and columns of returns whose file or sensor did not name them.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/types/scan.h"

namespace ca2 {

/// rad, in [-pi, pi]; error under 2e-5, which is a hundredth of the finest
/// column, at a fifth of atan2's time.
inline float fast_azimuth(float x, float y) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float a = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-30f), s = a * a;
  // Odd minimax polynomial of the arc tangent on [0, 1] (Abramowitz and
  // Stegun 4.4.49).
  float angle = a * (0.9998660f + s * (-0.3302995f + s * (0.1801410f + s * (-0.0851330f + s * 0.0208351f))));
  // Sums with a sign, without branches: loops over it are compiled for eight at a time.
  constexpr float half_turn = std::numbers::pi_v<float>;
  angle = (ay > ax ? half_turn / 2 : 0.0f) + (ay > ax ? -1.0f : 1.0f) * angle;
  angle = (x < 0 ? half_turn : 0.0f) + (x < 0 ? -1.0f : 1.0f) * angle;
  return (y < 0 ? -1.0f : 1.0f) * angle;
}

/// A return that is one: finite, and not the zeros some drivers write for a
/// missing return.
inline constexpr float least_square = 1e-4f, most_square = 1e8f;  // m^2
inline bool is_return(float squared_range) {
  return squared_range > least_square && squared_range < most_square;
}
inline bool is_return(const Eigen::Vector3f& p) {
  return is_return(p.squaredNorm());
}

/// A ring for every return, `none` for those that have no place. Missing
/// returns may have one.
struct RingIds {
  static constexpr std::uint16_t none = 0xffff;
  std::vector<std::uint16_t> found;  ///< empty: the scan's own
  int rings = 0;
  bool beams = false;  ///< they are the sensor's beams, not slices of elevation

  const std::vector<std::uint16_t>& of(const Scan& scan) const { return found.empty() ? scan.ring : found; }
};
RingIds find_rings(const Scan& scan);

/// A column for every return (meaningless where the ring is `none`): the given
/// or found id, counted backwards if so, and shifted with its ring.
struct ColumnIds {
  std::vector<std::uint32_t> found;  ///< empty: the scan's own
  int columns = 0;
  bool backwards = false;
  std::vector<std::uint32_t> shift;  ///< [ring], below `columns`

  const std::vector<std::uint32_t>& of(const Scan& scan) const { return found.empty() ? scan.column : found; }
};
ColumnIds find_columns(const Scan& scan, const RingIds& rings);

}  // namespace ca2
