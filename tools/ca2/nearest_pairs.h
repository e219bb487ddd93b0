/// @file What several sensors recorded, put together by number or time.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace ca2 {

/// The keys (numbers, or ns) of what a sensor recorded, by rising key.
using SensorKeys = std::pair<std::string, std::vector<std::int64_t>>;

struct Pairing {
  std::vector<std::map<std::string, std::size_t>> groups;  ///< by sensor: which of its keys
  std::size_t single = 0;                                  ///< of the slowest sensor, without a partner
};

/// The sensor with the fewest keys leads; to each of its keys the nearest of every other sensor, at most
/// `reach` away. With a single sensor every key is a group.
Pairing pair_nearest(const std::vector<SensorKeys>& sensors, std::int64_t reach);

}  // namespace ca2
