#include "drivers/camera/aravis/camera_clock.h"

#include <cmath>
#include <cstdlib>

namespace ca2 {

CameraClock::MidExposure CameraClock::middle(const Stamp& stamp) {
  const std::int64_t end = stamp.device + stamp.exposure;
  clock_.update(end, stamp.arrival);
  const ClockMapping& mapping = *clock_.mapping();
  const std::int64_t mapped = mapping.to_host(end) - stamp.exposure / 2;
  if (stamp.synchronized) {
    for (const std::int64_t ahead : {std::int64_t{0}, tai_minus_utc}) {
      const std::int64_t told = stamp.device - ahead + stamp.exposure / 2;
      if (std::abs(told - mapped) < ptp_tolerance) return {told, ptp_sigma};
    }
  }
  return {mapped, std::llround(mapping.sigma_ns(end))};
}

}  // namespace ca2
