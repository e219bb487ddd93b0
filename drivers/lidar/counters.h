/// @file What became of every datagram, by reason: kept even when decoding fails.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace ca2 {

struct LidarCounters {
#define CA2_LIDAR_COUNTER(name, help) std::uint64_t name = 0;  ///< help
#include "drivers/lidar/counters.def"
#undef CA2_LIDAR_COUNTER

  bool operator==(const LidarCounters&) const = default;
};

/// A row of counters.def, to print or to sum them.
struct LidarCounterInfo {
  std::string_view name;
  std::string_view help;
  std::uint64_t LidarCounters::*value;
};
std::span<const LidarCounterInfo> lidar_counter_table();

}  // namespace ca2
