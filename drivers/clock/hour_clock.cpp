#include "drivers/clock/hour_clock.h"

namespace ca2 {
namespace {

/// `time` plus as many hours as bring it nearest to `target`, ns.
std::int64_t nearest_hour(std::int64_t time, std::int64_t target) {
  const std::int64_t half = nanoseconds_per_hour / 2;
  std::int64_t rest = (target - time + half) % nanoseconds_per_hour;
  if (rest < 0) rest += nanoseconds_per_hour;
  return target + half - rest;
}

std::optional<std::int64_t> nanoseconds(std::uint32_t microseconds) {
  const std::int64_t time = std::int64_t{microseconds} * 1000;
  if (time >= nanoseconds_per_hour) return std::nullopt;
  return time;
}

}  // namespace

std::optional<std::int64_t> HourClock::unwrap(std::uint32_t microseconds, std::int64_t host) {
  const auto time = nanoseconds(microseconds);
  if (!time) return std::nullopt;
  const std::int64_t device = offset_ ? nearest_hour(*time, host - *offset_) : *time;
  offset_ = host - device;
  return device;
}

std::optional<std::int64_t> utc_from_hour(std::uint32_t microseconds, std::int64_t host) {
  const auto time = nanoseconds(microseconds);
  if (!time) return std::nullopt;
  // The epoch began at the top of an hour, and UTC's hours are all as long on this scale.
  return nearest_hour(*time, host);
}

}  // namespace ca2
