#include "tools/ca2/nearest_pairs.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace ca2 {
namespace {

std::optional<std::size_t> nearest(const std::vector<std::int64_t>& keys, std::int64_t key) {
  const auto after = std::lower_bound(keys.begin(), keys.end(), key);
  std::optional<std::size_t> best;
  if (after != keys.end()) best = static_cast<std::size_t>(after - keys.begin());
  if (after != keys.begin()) {
    const auto before = static_cast<std::size_t>(after - keys.begin()) - 1;
    if (!best || std::abs(keys[before] - key) < std::abs(keys[*best] - key)) best = before;
  }
  return best;
}

}  // namespace

Pairing pair_nearest(const std::vector<SensorKeys>& sensors, std::int64_t reach) {
  Pairing pairing;
  const auto leader = std::min_element(
      sensors.begin(), sensors.end(),
      [](const SensorKeys& a, const SensorKeys& b) { return a.second.size() < b.second.size(); });
  if (leader == sensors.end()) return pairing;
  for (std::size_t i = 0; i < leader->second.size(); ++i) {
    const std::int64_t key = leader->second[i];
    std::map<std::string, std::size_t> group{{leader->first, i}};
    for (const SensorKeys& other : sensors) {
      if (&other == &*leader) continue;
      const auto at = nearest(other.second, key);
      if (at && std::abs(other.second[*at] - key) <= reach) group[other.first] = *at;
    }
    if (group.size() > 1 || sensors.size() == 1) {
      pairing.groups.push_back(std::move(group));
    } else {
      ++pairing.single;
    }
  }
  return pairing;
}

}  // namespace ca2
