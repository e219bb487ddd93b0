/// @file The daemon's idea of now.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "drivers/camera/host_time.h"

namespace ca2 {

class HostClock {
 public:
  /// `begin`: ns UTC that it is now, for a recording in place of sensors; nothing: the system's clock.
  explicit HostClock(std::optional<std::int64_t> begin)
      : begin_(begin), start_(std::chrono::steady_clock::now()), offset_(offset()) {}

  std::int64_t now() const {  ///< ns UTC
    return begin_ ? *begin_ + std::chrono::nanoseconds(std::chrono::steady_clock::now() - start_).count()
                  : utc_now();
  }

  /// By how much the system's clock was set since the last call, ns; nothing below half a second, which is
  /// what an adjusted clock may creep and a busy host be late.
  std::optional<std::int64_t> jump() {
    constexpr std::int64_t tolerance = 500'000'000;
    const std::int64_t now = offset(), change = now - offset_;
    offset_ = now;
    if (begin_ || (change < tolerance && change > -tolerance)) return std::nullopt;
    return change;
  }

 private:
  static std::int64_t offset() { return utc_of({}); }  // of the steady clock's zero

  std::optional<std::int64_t> begin_;
  std::chrono::steady_clock::time_point start_;
  std::int64_t offset_;
};

}  // namespace ca2
