#include "drivers/lidar/scan_clock.h"

#include <algorithm>

namespace ca2 {

std::optional<TimedScan> ScanClock::map(LidarScan&& scan) {
  TimedScan out;
  for (const ClockSample& sample : scan.clock) {
    out.clock_jumped |= clock_.update(sample.device, sample.host) == DeviceClock::Update::jump;
  }
  if (!clock_.mapping() || scan.clock.empty()) return std::nullopt;
  // One mapping for the whole scan: its inner times stay consistent.
  const ClockMapping& mapping = *clock_.mapping();

  // Packets tell where the revolution begins and ends even if nothing came back there.
  const auto by_device = [](const ClockSample& a, const ClockSample& b) { return a.device < b.device; };
  const auto [first_packet, last_packet] =
      std::minmax_element(scan.clock.begin(), scan.clock.end(), by_device);
  std::int64_t first = first_packet->device, last = last_packet->device;
  for (std::int64_t& time : scan.scan.time) {
    first = std::min(first, time);
    last = std::max(last, time);
    time = mapping.to_host(time);
  }
  const std::int64_t middle = first + (last - first) / 2;
  out.time = mapping.to_host(middle);
  out.time_sigma = mapping.sigma_ns(middle);
  out.scan = pool_.keep(scan.scan);
  return out;
}

}  // namespace ca2
