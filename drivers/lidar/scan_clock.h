/// @file Scans on the host's clock: what hosts of the capture pipeline do between decoding and searching.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/types/scan.h"
#include "drivers/clock/device_clock.h"
#include "drivers/lidar/lidar_scan.h"
#include "drivers/shared_pool.h"

namespace ca2 {

/// A scan whose times are ns UTC on the host's clock.
struct TimedScan {
  std::shared_ptr<const Scan> scan;
  std::int64_t time = 0;      ///< ns UTC: the middle of the revolution
  double time_sigma = 0;      ///< ns
  bool clock_jumped = false;  ///< the sensor's clock was set, or the sensor restarted, during this scan
};

/// One per LiDAR; scans in the order of their frames. Pure: the same scans give the same times.
class ScanClock {
 public:
  /// Nothing for a scan without packets. What is left in `scan` is memory for the decoder to use again.
  std::optional<TimedScan> map(LidarScan&& scan);

 private:
  DeviceClock clock_;
  SharedPool<Scan> pool_;
};

}  // namespace ca2
