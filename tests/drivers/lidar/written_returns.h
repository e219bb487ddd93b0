/// @file What a way of writing returns wrote, to compare with another's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "drivers/lidar/return_writer.h"

namespace ca2 {

/// Arrays of a scan, with room for all that can be fired at once and for what is written beyond it.
struct WrittenReturns {
  static constexpr std::size_t most = FiredBeams::most + 16;
  std::array<float, 3 * most> points{};
  std::array<float, most> range{}, intensity{};
  std::array<std::uint16_t, most> ring{};
  std::array<std::uint32_t, most> column{};
  std::array<std::int64_t, most> time{};

  detail::ReturnTargets targets() {
    return {points.data(), range.data(), intensity.data(), ring.data(), column.data(), time.data()};
  }
  /// So many of them, as bytes: a NaN is equal to itself.
  bool same(const WrittenReturns& other, std::size_t n) const {
    const auto equal = [n](const auto& a, const auto& b, std::size_t each) {
      return std::memcmp(a.data(), b.data(), n * each * sizeof a[0]) == 0;
    };
    return equal(points, other.points, 3) && equal(range, other.range, 1) &&
           equal(intensity, other.intensity, 1) && equal(ring, other.ring, 1) &&
           equal(column, other.column, 1) && equal(time, other.time, 1);
  }
};

}  // namespace ca2
