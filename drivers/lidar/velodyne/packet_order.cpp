#include "drivers/lidar/velodyne/packet_order.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ca2 {
namespace {

constexpr std::int64_t hour_us = 3'600'000'000;
constexpr std::int64_t hour_ns = hour_us * 1000;
/// us: nothing is lost or delayed for so long; beyond it the clock was set.
constexpr std::int64_t jump_us = 1'000'000;

/// us from b to a, across the top of the hour.
std::int64_t between(std::uint32_t a, std::uint32_t b) {
  std::int64_t d = (static_cast<std::int64_t>(a) - b) % hour_us;
  if (d > hour_us / 2) d -= hour_us;
  if (d < -hour_us / 2) d += hour_us;
  return d;
}

/// The time nearest to the host's that has `stamp` microseconds in its hour.
std::int64_t absolute(std::uint32_t stamp, std::int64_t host_time) {
  std::int64_t hour = host_time / hour_ns;
  if (host_time % hour_ns < 0) --hour;
  const std::int64_t within = static_cast<std::int64_t>(stamp) * 1000;
  const std::int64_t offset = within - (host_time - hour * hour_ns);
  if (offset > hour_ns / 2) --hour;
  if (offset < -hour_ns / 2) ++hour;
  return hour * hour_ns + within;
}

/// Time stamps are whole microseconds and the period of some firmware is not known to better than 10 %.
bool follows(std::int64_t since, double period) {
  return static_cast<double>(since) < 1.5e6 * period;
}

}  // namespace

bool VelodynePacketOrder::seen(std::uint32_t stamp) const {
  const std::size_t n = std::min(stamp_count_, stamps_.size());
  return std::find(stamps_.begin(), stamps_.begin() + static_cast<std::ptrdiff_t>(n), stamp) !=
         stamps_.begin() + static_cast<std::ptrdiff_t>(n);
}

void VelodynePacketOrder::remember(std::uint32_t stamp) {
  stamps_[stamp_count_++ % stamps_.size()] = stamp;
}

void VelodynePacketOrder::push(const std::uint8_t* packet, std::int64_t host_time, double period,
                               LidarCounters& counters, const Sink& sink) {
  const std::uint32_t stamp = VelodynePacket::timestamp(packet);
  if (started_ && (std::abs(between(stamp, last_stamp_)) >= jump_us || late_run_ > 200)) {
    flush(counters, sink);
    ++counters.restarts;
    jumped_ = true;
  }
  if (!started_) start_before(stamp);
  const std::int64_t since = between(stamp, last_stamp_);
  if (since <= 0) {
    ++(seen(stamp) ? counters.duplicates : counters.late);
    // A clock that was set back by less than a second looks like packets that are all late.
    ++late_run_;
    return;
  }
  late_run_ = 0;
  if (follows(since, last_period_)) {
    pass(packet, host_time, since, period, counters, sink);
    pass_waiting(false, counters, sink);
    return;
  }
  const auto at =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& w) { return w.since >= since; });
  if (at != waiting_.end() && at->since == since) {
    ++counters.duplicates;
    return;
  }
  Waiting entry{{}, host_time, since, period};
  std::memcpy(entry.bytes.data(), packet, entry.bytes.size());
  waiting_.insert(at, entry);
  pass_waiting(false, counters, sink);
}

void VelodynePacketOrder::pass_waiting(bool all, LidarCounters& counters, const Sink& sink) {
  while (!waiting_.empty()) {
    const Waiting& next = waiting_.front();
    if (!all && !follows(next.since, last_period_) && waiting_.size() <= depth) return;
    const Waiting entry = next;
    waiting_.erase(waiting_.begin());
    pass(entry.bytes.data(), entry.host_time, entry.since, entry.period, counters, sink);
  }
}

/// As if a packet had been passed on long before: the first ones wait too, for the first to arrive need not
/// be the first that was sent.
void VelodynePacketOrder::start_before(std::uint32_t stamp) {
  started_ = fresh_ = true;
  late_run_ = 0;
  stamp_count_ = 0;
  last_period_ = 0;
  last_stamp_ = static_cast<std::uint32_t>((stamp + hour_us - jump_us / 2) % hour_us);
}

void VelodynePacketOrder::pass(const std::uint8_t* packet, std::int64_t host_time, std::int64_t since,
                               double period, LidarCounters& counters, const Sink& sink) {
  for (Waiting& waiting : waiting_) waiting.since -= since;
  last_stamp_ = VelodynePacket::timestamp(packet);
  remember(last_stamp_);
  OrderedPacket ordered{packet, 0, host_time, 0, false};
  if (fresh_) {
    device_time_ = absolute(last_stamp_, host_time);
    ordered.restart = jumped_;
    fresh_ = jumped_ = false;
  } else {
    device_time_ += since * 1000;
    if (!follows(since, last_period_)) {
      ordered.gap = std::max(static_cast<double>(since) * 1e-6 - last_period_, 0.0);
      counters.missing_packets += static_cast<std::uint64_t>(std::llround(ordered.gap / period));
    }
  }
  ordered.device_time = device_time_;
  last_period_ = period;
  sink(ordered);
}

void VelodynePacketOrder::push_untimed(const std::uint8_t* packet, std::int64_t host_time, double period,
                                       LidarCounters& counters, const Sink& sink) {
  if (std::memcmp(packet, untimed_.data(), untimed_.size()) == 0) {
    ++counters.duplicates;
    return;
  }
  std::memcpy(untimed_.data(), packet, untimed_.size());
  sink({packet, host_time - std::llround(period * 1e9), host_time, 0, false});
}

void VelodynePacketOrder::flush(LidarCounters& counters, const Sink& sink) {
  pass_waiting(true, counters, sink);
  started_ = false;
}

}  // namespace ca2
