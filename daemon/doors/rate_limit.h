/// @file How often somebody may ask.
#pragma once

#include <algorithm>
#include <chrono>

namespace ca2 {

/// A bucket of tokens: `rate` per second on average, `burst` at once.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  RateLimit(double rate, double burst) : rate_(rate), burst_(burst), tokens_(burst) {}

  bool allow(Clock::time_point now) {
    tokens_ = std::min(burst_, tokens_ + rate_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (tokens_ < 1) return false;
    tokens_ -= 1;
    return true;
  }

 private:
  double rate_, burst_, tokens_;
  Clock::time_point last_{};
};

}  // namespace ca2
