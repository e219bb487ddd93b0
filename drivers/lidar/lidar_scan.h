/// @file What a LiDAR driver gives out: a scan and how it came about.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/types/scan.h"

namespace ca2 {

/// One packet seen by two clocks: what a clock mapping learns from.
struct ClockSample {
  std::int64_t device = 0;  ///< ns, the sensor's clock: first measurement of the packet
  std::int64_t host = 0;    ///< ns UTC, when the host received it

  bool operator==(const ClockSample&) const = default;
};

/// A return without the rounding to float (up to 8 um at 100 m).
struct ExactReturn {
  Eigen::Vector3d point;  ///< m
  double range;           ///< m
};

struct LidarScan {
  Scan scan;  ///< time: ns on the sensor's clock (Velodyne: UTC from the host's hour and the sensor's us)
  std::vector<ExactReturn> exact;  ///< empty, or one per point: LidarDriverOptions::exact
  std::uint32_t frame_id = 0;      ///< Ouster: the sensor's; Velodyne: counted
  bool complete = false;  ///< Ouster: no packet of the window missing; Velodyne: no gap, cut at both ends
  int missing_packets = 0;
  std::vector<ClockSample> clock;  ///< one per packet, in the order of arrival
};

/// May take the scan; what it leaves, the decoder uses again.
using LidarSink = std::function<void(LidarScan&&)>;

/// Makes a scan ready for a ReturnWriter: all is reset but the returns' arrays, whose memory it uses as it
/// is.
void reuse(LidarScan& scan);

}  // namespace ca2
