/// @file What a thread has used of a core.
#pragma once

#include <ctime>

namespace ca2 {

/// CPU time of the calling thread since it began, ms.
inline double thread_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace ca2
