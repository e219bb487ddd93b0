/// @file The host's clocks: UTC that pictures are stamped with, and the steady one that nobody sets.
#pragma once

#include <chrono>
#include <cstdint>

namespace ca2 {

inline std::int64_t utc_now() {
  using std::chrono::duration_cast, std::chrono::nanoseconds, std::chrono::system_clock;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

/// ns UTC of a reading of the steady clock, as the two stand to each other now.
inline std::int64_t utc_of(std::chrono::steady_clock::time_point time) {
  const auto before = std::chrono::steady_clock::now();
  const std::int64_t utc = utc_now();
  const auto after = std::chrono::steady_clock::now();
  // The steady reading that goes with `utc` is between the two.
  return utc + std::chrono::nanoseconds(time - before - (after - before) / 2).count();
}

}  // namespace ca2
