/// @file A stop that wakes who waits, from any thread and from a signal handler.
#pragma once

#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "drivers/net/unique_fd.h"

namespace ca2 {

/// Set once, for ever. The descriptor is readable from then on: for poll() beside others.
class StopEvent {
 public:
  StopEvent() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

  /// False when the system had no descriptor left; errno says so.
  bool valid() const { return fd_.valid(); }

  void set() noexcept {
    set_.store(true, std::memory_order_release);
    const std::uint64_t one = 1;
    // Cannot fail but when the counter is full, and then who waits is awake.
    [[maybe_unused]] const auto written = ::write(fd_.get(), &one, sizeof one);
  }
  bool is_set() const noexcept { return set_.load(std::memory_order_acquire); }
  int fd() const { return fd_.get(); }

  /// Sleeps until set or until the time is over; true when set.
  bool wait_until(std::chrono::steady_clock::time_point end) const {
    for (;;) {
      if (is_set()) return true;
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      if (left.count() <= 0) return false;
      pollfd polled{fd_.get(), POLLIN, 0};
      ::poll(&polled, 1, static_cast<int>(std::min<std::int64_t>(left.count(), 60'000)));
    }
  }

 private:
  UniqueFd fd_;
  std::atomic<bool> set_{false};
};

}  // namespace ca2
