// Sixteen beams at a time: the processor orders them by the mask of those that are returns.
#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>
#include <array>

#include "drivers/lidar/return_writer.h"

#define CA2_AVX512 __attribute__((target("avx512f,avx512bw,avx512vl,popcnt")))

namespace ca2::detail {
namespace {

/// Where the numbers of three registers of points come from: the first two of a point from x and y, in one
/// step, then the third from z. 16 and up: of the second of the two registers.
struct Interleaved {
  alignas(64) std::array<std::array<int, 16>, 3> from_xy{}, with_z{};
};
constexpr Interleaved make_interleaved() {
  Interleaved out;
  for (int i = 0; i < 48; ++i) {
    const auto part = static_cast<std::size_t>(i / 16), lane = static_cast<std::size_t>(i % 16);
    const int point = i / 3, axis = i % 3;
    out.from_xy[part][lane] = axis == 1 ? 16 + point : point;
    out.with_z[part][lane] = axis == 2 ? 16 + point : i % 16;
  }
  return out;
}
constexpr Interleaved interleaved = make_interleaved();

/// x0 y0 z0 x1 ... of sixteen points.
CA2_AVX512 inline void store_points(float* out, __m512 x, __m512 y, __m512 z) {
#pragma GCC unroll 3
  for (std::size_t part = 0; part < 3; ++part) {
    const __m512i from_xy = _mm512_load_si512(interleaved.from_xy[part].data());
    const __m512i with_z = _mm512_load_si512(interleaved.with_z[part].data());
    const __m512 xy = _mm512_permutex2var_ps(x, from_xy, y);
    _mm512_storeu_ps(out + 16 * part, _mm512_permutex2var_ps(xy, with_z, z));
  }
}

template <bool delayed>
CA2_AVX512 std::size_t write_sixteens(const FiredBeams& beams, const FiredNames& names,
                                      const ReturnTargets& out) {
  // In variables of their own, which what is written cannot change.
  const FiredNames in = names;
  const ReturnTargets to = out;
  const __m512i time = _mm512_set1_epi64(in.time), column = _mm512_set1_epi32(static_cast<int>(in.column));
  const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  std::size_t n = 0;
  for (int i = 0; i < in.beams; i += 16) {
    const auto here = static_cast<__mmask16>((1u << std::min(in.beams - i, 16)) - 1);
    const __m512i count = _mm512_maskz_loadu_epi32(here, in.counts + i);
    const __mmask16 kept = _mm512_test_epi32_mask(count, count);
    const auto returns = static_cast<std::size_t>(_mm_popcnt_u32(kept));
    const __m512i order = _mm512_maskz_compress_epi32(kept, lanes);
    const auto packed = [&](const float* from) CA2_AVX512 {
      return _mm512_maskz_permutexvar_ps(0xffff, order, _mm512_maskz_loadu_ps(here, from + in.first + i));
    };
    const auto ordered = [&](__m512i values)
                             CA2_AVX512 { return _mm512_maskz_permutexvar_epi32(0xffff, order, values); };
    store_points(to.points + 3 * n, packed(beams.x), packed(beams.y), packed(beams.z));
    _mm512_storeu_ps(to.range + n, packed(beams.range));
    const __m512i intensity = _mm512_maskz_cvtepu8_epi32(here, _mm_maskz_loadu_epi8(here, in.intensity + i));
    _mm512_storeu_ps(to.intensity + n, _mm512_maskz_cvtepi32_ps(0xffff, ordered(intensity)));
    const __m512i ring = _mm512_maskz_cvtepu16_epi32(here, _mm256_maskz_loadu_epi16(here, in.ring + i));
    _mm256_storeu_epi16(to.ring + n, _mm512_maskz_cvtepi32_epi16(0xffff, ordered(ring)));
    _mm512_storeu_si512(to.column + n, column);
    __m512i first = time, last = time;
    if constexpr (delayed) {
      const __m512i delay = ordered(_mm512_maskz_loadu_epi32(here, in.delay + i));
      const __m256i low = _mm512_maskz_extracti64x4_epi64(0xff, delay, 0),
                    high = _mm512_maskz_extracti64x4_epi64(0xff, delay, 1);
      first = _mm512_add_epi64(time, _mm512_maskz_cvtepu32_epi64(0xff, low));
      last = _mm512_add_epi64(time, _mm512_maskz_cvtepu32_epi64(0xff, high));
    }
    _mm512_storeu_si512(to.time + n, first);
    _mm512_storeu_si512(to.time + n + 8, last);
    n += returns;
  }
  return n;
}

}  // namespace

std::size_t write_returns_avx512(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out) {
  return names.delay ? write_sixteens<true>(beams, names, out) : write_sixteens<false>(beams, names, out);
}

}  // namespace ca2::detail
#endif
