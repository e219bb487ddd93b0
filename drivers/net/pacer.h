/// @file When recorded datagrams are due, for hosts that replay them in time.
#pragma once

#include <algorithm>
#include <cstdint>

namespace ca2 {

/// Maps the stamps of a recording to a steady clock. Pure: the clock's readings are passed in, the waiting
/// is the host's. The schedule is absolute, so late datagrams do not delay those after them.
class Pacer {
 public:
  /// `speed`: 1 as recorded, 2 twice as fast; 0 as fast as possible.
  explicit Pacer(double speed) : speed_(speed) {}

  /// ns to wait from `now` (steady clock, ns) until the datagram stamped `time` (ns) is due; 0: at once.
  /// The first datagram is due when it is first asked for.
  std::int64_t wait(std::int64_t time, std::int64_t now) {
    if (speed_ <= 0) return 0;
    if (!started_) {
      started_ = true;
      start_ = {time, now};
    }
    // In floating point, so that a damaged stamp cannot overflow; the limit is some 30 years.
    const double elapsed = (static_cast<double>(time) - static_cast<double>(start_.recorded)) / speed_;
    const std::int64_t left = start_.now + static_cast<std::int64_t>(std::clamp(elapsed, -1e18, 1e18)) - now;
    return left > 0 ? left : 0;
  }

 private:
  struct Start {
    std::int64_t recorded = 0, now = 0;  ///< ns
  };
  double speed_;
  bool started_ = false;
  Start start_;  ///< of the first datagram
};

}  // namespace ca2
