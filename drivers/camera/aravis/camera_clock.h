/// @file From a camera's time stamp to the middle of the exposure, ns UTC.
#pragma once

#include <cstdint>

#include "drivers/clock/device_clock.h"

namespace ca2 {

/// Pure: all times are passed in.
class CameraClock {
 public:
  struct Stamp {
    std::int64_t device = 0;    ///< ns on the camera's clock, start of the exposure
    std::int64_t arrival = 0;   ///< ns UTC when the picture's first packet came
    std::int64_t exposure = 0;  ///< ns
    bool synchronized = false;  ///< the camera says that its clock follows a PTP master
  };
  struct MidExposure {
    std::int64_t time = 0;   ///< ns UTC
    std::int64_t sigma = 0;  ///< ns
  };

  /// The first packet leaves when the exposure is over, so arrivals mark the end of the exposure with the
  /// least delay of the window; whether the camera stamps the start or the end drops out as long as the
  /// exposure stays. A synchronised clock is believed where it tells UTC, or TAI (37 s ahead), within
  /// `ptp_tolerance` of that.
  MidExposure middle(const Stamp& stamp);

  static constexpr std::int64_t ptp_tolerance = 10'000'000;  ///< ns: arrivals are late by the network
  static constexpr std::int64_t ptp_sigma = 50'000;  ///< ns: what a software-stamped master is good for
  static constexpr std::int64_t tai_minus_utc = 37'000'000'000;

 private:
  DeviceClock clock_;
};

}  // namespace ca2
