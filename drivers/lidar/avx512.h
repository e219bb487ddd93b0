/// @file Marks functions for processors with AVX-512 F, BW and VL, and tells whether this is one.
#pragma once

#if defined(__x86_64__)
#define CA2_AVX512 __attribute__((target("avx512f,avx512bw,avx512vl,popcnt")))

namespace ca2 {

inline bool has_avx512() {
  static const bool has = __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("avx512f") &&
                          __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  return has;
}

}  // namespace ca2
#endif
