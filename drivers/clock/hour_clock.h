/// @file Velodyne's time stamps: microseconds since the top of an hour, which start anew every hour.
#pragma once

#include <cstdint>
#include <optional>

namespace ca2 {

constexpr std::int64_t nanoseconds_per_hour = 3'600'000'000'000;

/// Makes them a time that does not wrap.
class HourClock {
 public:
  /// ns on a scale of its own that runs on through the hours, for a packet stamped `microseconds` that
  /// arrived at `host` (ns UTC). The hours missed during a silence are told by the host's clock, so the two
  /// may part by up to half an hour between packets. Nothing for stamps that no clock shows (an hour or
  /// more).
  std::optional<std::int64_t> unwrap(std::uint32_t microseconds, std::int64_t host);

 private:
  std::optional<std::int64_t> offset_;  ///< host - device at the last packet, ns
};

/// ns UTC of a stamp of a sensor that is locked to PPS and NMEA: the one within half an hour of `host`.
/// Nothing for stamps of an hour or more.
std::optional<std::int64_t> utc_from_hour(std::uint32_t microseconds, std::int64_t host);

}  // namespace ca2
