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
  using std::chrono::steady_clock, std::chrono::nanoseconds;
  std::int64_t answer = 0;
  auto least = steady_clock::duration::max();
  // A thread that is put to sleep between two readings is off by milliseconds: another try is not.
  for (int i = 0; i < 5 && least > std::chrono::microseconds(5); ++i) {
    const auto before = steady_clock::now();
    const std::int64_t utc = utc_now();
    const auto between = steady_clock::now() - before;
    if (between >= least) continue;
    least = between;
    // The steady reading that goes with `utc` is within `between`.
    answer = utc + nanoseconds(time - before - between / 2).count();
  }
  return answer;
}

}  // namespace ca2
