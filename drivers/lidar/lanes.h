/// @file Arithmetic on eight numbers at once, in the compilers' portable vectors: SSE2 and NEON take each as
/// two registers, and functions marked CA2_LANES have a second body for AVX2, chosen when the program starts.
#pragma once

#include <cstdint>
#include <cstring>

// Clones need the dynamic linker's help, which sanitizers get in the way of; clang before 18 has none in C++.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CA2_LANES __attribute__((target_clones("avx2", "default")))
#else
#define CA2_LANES
#endif
// A call would pass the numbers through memory.
#define CA2_LANES_INLINE __attribute__((always_inline)) inline

namespace ca2::lanes {

constexpr int count = 8;
using Floats = float __attribute__((vector_size(4 * count)));
using Ints = std::int32_t __attribute__((vector_size(4 * count)));

CA2_LANES_INLINE void load(Floats& out, const float* from) {
  std::memcpy(&out, from, sizeof out);
}
CA2_LANES_INLINE void store(float* to, const Floats& in) {
  std::memcpy(to, &in, sizeof in);
}

/// Numbers below 2^31.
CA2_LANES_INLINE void load(Floats& out, const std::uint32_t* from) {
  Ints ints;
  std::memcpy(&ints, from, sizeof ints);
  out = __builtin_convertvector(ints, Floats);
}

/// How many numbers arrays need so that whole lanes of them can be read and written.
constexpr int padded(int size) {
  return (size + count - 1) / count * count;
}

}  // namespace ca2::lanes
