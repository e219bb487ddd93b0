/// @file Arithmetic on four numbers at once, for the bodies of functions marked CA2_HOT_LOOP.
#pragma once

#include <cstring>

namespace ca2 {

/// The compilers' portable vectors: two SSE2 or NEON registers, or one of AVX2.
using Four = double __attribute__((vector_size(32)));

// A call would pass them through memory.
#define CA2_FOUR_INLINE __attribute__((always_inline)) inline

CA2_FOUR_INLINE void load(Four& out, const double* from) {
  std::memcpy(&out, from, sizeof out);
}
CA2_FOUR_INLINE void load(Four& out, const float* from) {
  float __attribute__((vector_size(16))) floats;
  std::memcpy(&floats, from, sizeof floats);
  out = __builtin_convertvector(floats, Four);
}
CA2_FOUR_INLINE void store(double* to, const Four& in) {
  std::memcpy(to, &in, sizeof in);
}
CA2_FOUR_INLINE void store(float* to, const Four& in) {
  using Floats = float __attribute__((vector_size(16)));
  const Floats floats = __builtin_convertvector(in, Floats);
  std::memcpy(to, &floats, sizeof floats);
}
CA2_FOUR_INLINE double sum(const Four& of) {
  return (of[0] + of[1]) + (of[2] + of[3]);
}

#undef CA2_FOUR_INLINE

}  // namespace ca2
