#include "drivers/camera/t265/device_time.h"

#include <algorithm>
#include <cmath>

namespace ca2::t265 {

DeviceClockOptions DeviceTime::options() {
  DeviceClockOptions options;
  options.slot = 500'000'000;  // ns, as often as the clock is read
  options.first_sigma = 500'000;
  // What it cannot see is half a round trip, and that is measured here.
  options.fixed_sigma = 0;
  return options;
}

void DeviceTime::add(std::uint64_t device, std::int64_t sent, std::int64_t received) {
  // The response comes late by chance and never early: just what DeviceClock is for.
  const auto verdict = clock_.update(static_cast<std::int64_t>(device), received);
  const std::int64_t round_trip = std::max<std::int64_t>(received - sent, 0);
  if (!least_round_trip_ || verdict == DeviceClock::Update::jump) least_round_trip_ = round_trip;
  least_round_trip_ = std::min(*least_round_trip_, round_trip);
}

std::optional<DeviceTime::Stamp> DeviceTime::at(std::uint64_t device) const {
  if (!clock_.mapping() || !least_round_trip_) return std::nullopt;
  const auto time = static_cast<std::int64_t>(device);
  // The quickest response took between nothing and the whole quickest round trip.
  const std::int64_t half = *least_round_trip_ / 2;
  Stamp out;
  out.time = clock_.mapping()->to_host(time) - half;
  out.sigma = std::llround(std::hypot(clock_.mapping()->sigma_ns(time), static_cast<double>(half)));
  return out;
}

}  // namespace ca2::t265
