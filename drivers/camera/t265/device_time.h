/// @file When a T265's pictures were taken, in host time.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/clock/device_clock.h"

namespace ca2::t265 {

/// From readings of the device's clock. Pure: all times are passed in.
class DeviceTime {
 public:
  /// The clock said `device` (ns) between the host times `sent` and `received` (ns UTC).
  void add(std::uint64_t device, std::int64_t sent, std::int64_t received);

  struct Stamp {
    std::int64_t time = 0;   ///< ns UTC
    std::int64_t sigma = 0;  ///< ns
  };
  /// Nothing before the first reading.
  std::optional<Stamp> at(std::uint64_t device) const;

 private:
  static DeviceClockOptions options();

  DeviceClock clock_{options()};
  std::optional<std::int64_t> least_round_trip_;  ///< ns
};

}  // namespace ca2::t265
