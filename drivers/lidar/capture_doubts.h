/// @file What to say of a capture file that was read to its end.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/lidar/lidar_driver.h"
#include "drivers/net/packet_counters.h"

namespace ca2 {

/// Whether its recorder kept the beginnings of packets only: then there is nothing to decode.
std::optional<Problem> cut_packets(const std::string& file, const PacketCounters& packets);

/// Why the scans of a capture file may be fewer than the sensor gave: warnings, none where all is well.
/// `driver` was given what `packets` counts.
std::vector<Problem> capture_doubts(const std::string& file, const LidarDriver& driver,
                                    const PacketCounters& packets);

}  // namespace ca2
