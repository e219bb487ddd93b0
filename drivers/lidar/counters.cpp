#include "drivers/lidar/counters.h"

namespace ca2 {

std::span<const LidarCounterInfo> lidar_counter_table() {
  static constexpr LidarCounterInfo table[] = {
#define CA2_LIDAR_COUNTER(name, help) {#name, help, &LidarCounters::name},
#include "drivers/lidar/counters.def"
#undef CA2_LIDAR_COUNTER
  };
  return table;
}

}  // namespace ca2
