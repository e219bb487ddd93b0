/// @file Returns into the arrays of a scan with AVX-512, sixteen beams at a time: the processor orders them
/// by the mask of those that are returns.
#pragma once

#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>
#include <array>

#include "drivers/lidar/avx512.h"
#include "drivers/lidar/return_writer.h"

namespace ca2::detail {

/// Where sixteen beams met something; where they did not, any number.
struct SixteenPlaces {
  __m512 x, y, z, range;  ///< m
};

/// What came of sixteen beams: as FiredNames' arrays of the same names, in 32 bits.
struct SixteenBeams {
  __m512i counts, intensity;
};

/// From these arrays, of so many beams from this one on.
CA2_AVX512 inline SixteenBeams load_sixteen(const FiredNames& names, int beam, __mmask16 here) {
  return {_mm512_maskz_loadu_epi32(here, names.counts + beam),
          _mm512_maskz_cvtepu8_epi32(here, _mm_maskz_loadu_epi8(here, names.intensity + beam))};
}

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
inline constexpr Interleaved interleaved = make_interleaved();

/// x0 y0 z0 x1 ... of sixteen points.
CA2_AVX512 inline void store_sixteen_points(float* out, __m512 x, __m512 y, __m512 z) {
#pragma GCC unroll 3
  for (std::size_t part = 0; part < 3; ++part) {
    const __m512i from_xy = _mm512_load_si512(interleaved.from_xy[part].data());
    const __m512i with_z = _mm512_load_si512(interleaved.with_z[part].data());
    const __m512 xy = _mm512_permutex2var_ps(x, from_xy, y);
    _mm512_storeu_ps(out + 16 * part, _mm512_permutex2var_ps(xy, with_z, z));
  }
}

/// Writes the returns of what was fired from place `at` on and says where the next ones go.
/// `places(beam, here, counts)` gives the places of the sixteen beams from `beam` on, of which there are
/// `here`: in registers, for what is stored in narrower pieces has to reach the cache before it can be read
/// in one.
template <bool delayed, class Beams, class Places>
CA2_AVX512 inline std::size_t write_sixteens(const FiredNames& names, const ReturnTargets& out,
                                             std::size_t at, const Beams& beams, const Places& places) {
  // In variables of their own, which what is written cannot change.
  const FiredNames in = names;
  const ReturnTargets to = out;
  const __m512i time = _mm512_set1_epi64(in.time), column = _mm512_set1_epi32(static_cast<int>(in.column));
  const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  std::size_t n = at;
  for (int i = 0; i < in.beams; i += 16) {
    const auto here = static_cast<__mmask16>((1u << std::min(in.beams - i, 16)) - 1);
    const SixteenBeams fired = beams(i, here);
    const __mmask16 kept = _mm512_test_epi32_mask(fired.counts, fired.counts);
    const auto returns = static_cast<std::size_t>(_mm_popcnt_u32(kept));
    const __m512i order = _mm512_maskz_compress_epi32(kept, lanes);
    const auto packed = [&](__m512 values)
                            CA2_AVX512 { return _mm512_maskz_permutexvar_ps(0xffff, order, values); };
    const auto ordered = [&](__m512i values)
                             CA2_AVX512 { return _mm512_maskz_permutexvar_epi32(0xffff, order, values); };
    const SixteenPlaces seen = places(i, here, fired.counts);
    store_sixteen_points(to.points + 3 * n, packed(seen.x), packed(seen.y), packed(seen.z));
    _mm512_storeu_ps(to.range + n, packed(seen.range));
    // Both in one register while they are put in order.
    const __m512i ring = _mm512_maskz_cvtepu16_epi32(here, _mm256_maskz_loadu_epi16(here, in.ring + i));
    const __m512i both = ordered(_mm512_or_si512(_mm512_maskz_slli_epi32(0xffff, ring, 8), fired.intensity));
    const __m512i low_byte = _mm512_and_si512(both, _mm512_set1_epi32(0xff));
    _mm512_storeu_ps(to.intensity + n, _mm512_maskz_cvtepi32_ps(0xffff, low_byte));
    const __m512i others = _mm512_maskz_srli_epi32(0xffff, both, 8);
    _mm256_storeu_epi16(to.ring + n, _mm512_maskz_cvtepi32_epi16(0xffff, others));
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

}  // namespace ca2::detail
#endif
