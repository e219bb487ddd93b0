/// @file What benchmarks measure with.
#pragma once

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace ca2 {

/// CPU time of this thread, ns.
inline double cpu_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

/// The same, ms.
inline double cpu_ms() {
  return 1e-6 * cpu_ns();
}

/// Keeps the optimiser from seeing that a result is not used.
inline void keep(const void* pointer) {
  asm volatile("" : : "g"(pointer) : "memory");
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ca2
