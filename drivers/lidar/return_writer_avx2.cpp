// Eight beams at a time: their order is looked up by the mask of those that are returns.
#if defined(__x86_64__)
#include <immintrin.h>

#include <array>

#include "drivers/lidar/return_writer.h"

namespace ca2::detail {
namespace {

/// By a mask of eight lanes: their numbers, those of the set bits first.
constexpr std::array<std::array<std::uint8_t, 8>, 256> make_orders() {
  std::array<std::array<std::uint8_t, 8>, 256> orders{};
  for (unsigned mask = 0; mask < 256; ++mask) {
    std::size_t n = 0;
    for (unsigned lane = 0; lane < 8; ++lane) {
      if (mask >> lane & 1) orders[mask][n++] = static_cast<std::uint8_t>(lane);
    }
  }
  return orders;
}
constexpr auto orders = make_orders();

__attribute__((target("avx2"))) inline __m128i load128(const void* from) {
  return _mm_loadu_si128(static_cast<const __m128i*>(from));
}
__attribute__((target("avx2"))) inline __m256i load256(const void* from) {
  return _mm256_loadu_si256(static_cast<const __m256i*>(from));
}
__attribute__((target("avx2"))) inline void store256(void* to, __m256i value) {
  _mm256_storeu_si256(static_cast<__m256i*>(to), value);
}

/// Eight bytes as numbers of 32 bits.
__attribute__((target("avx2"))) inline __m256i bytes_at(const void* from) {
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64(static_cast<const __m128i*>(from)));
}

/// x0 y0 z0 x1 ... of eight points.
__attribute__((target("avx2"))) inline void store_points(float* out, __m256 x, __m256 y, __m256 z) {
  // Within halves of four points first, as with four lanes ...
  const __m256 low = _mm256_unpacklo_ps(x, y), high = _mm256_unpackhi_ps(x, y);
  const __m256 a = _mm256_shuffle_ps(low, _mm256_shuffle_ps(z, low, 0b10100000), 0b10000100);
  const __m256 b = _mm256_shuffle_ps(_mm256_shuffle_ps(low, z, 0b01011111), high, 0b01001000);
  const __m256 c = _mm256_shuffle_ps(_mm256_shuffle_ps(z, high, 0b10101010),
                                     _mm256_shuffle_ps(high, z, 0b11111111), 0b10001000);
  // ... then the halves one after the other.
  _mm256_storeu_ps(out, _mm256_permute2f128_ps(a, b, 0x20));
  _mm256_storeu_ps(out + 8, _mm256_permute2f128_ps(c, a, 0x30));
  _mm256_storeu_ps(out + 16, _mm256_permute2f128_ps(b, c, 0x31));
}

template <bool delayed>
__attribute__((target("avx2,popcnt"))) std::size_t write_eights(const FiredBeams& beams,
                                                                const FiredNames& names,
                                                                const ReturnTargets& out, std::size_t at) {
  // In variables of their own, which what is written cannot change.
  const FiredNames in = names;
  const ReturnTargets to = out;
  const __m256i zero = _mm256_setzero_si256(), time = _mm256_set1_epi64x(in.time);
  const __m256i column = _mm256_set1_epi32(static_cast<int>(in.column));
  std::size_t n = at;
  const auto eight = [&](int i, unsigned wanted) __attribute__((target("avx2,popcnt"), always_inline)) {
    const __m256i missing = _mm256_cmpeq_epi32(load256(in.counts + i), zero);
    const unsigned kept = ~static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(missing))) & wanted;
    const __m256i order = bytes_at(orders[kept].data());
    const auto packed = [&](const float* from) __attribute__((target("avx2"))) {
      return _mm256_permutevar8x32_ps(_mm256_load_ps(from + in.first + i), order);
    };
    store_points(to.points + 3 * n, packed(beams.x), packed(beams.y), packed(beams.z));
    _mm256_storeu_ps(to.range + n, packed(beams.range));
    const __m256i intensity = _mm256_permutevar8x32_epi32(bytes_at(in.intensity + i), order);
    _mm256_storeu_ps(to.intensity + n, _mm256_cvtepi32_ps(intensity));
    const __m256i ring = _mm256_permutevar8x32_epi32(_mm256_cvtepu16_epi32(load128(in.ring + i)), order);
    const __m256i narrow = _mm256_permute4x64_epi64(_mm256_packus_epi32(ring, zero), 0b1000);
    _mm_storeu_si128(static_cast<__m128i*>(static_cast<void*>(to.ring + n)), _mm256_castsi256_si128(narrow));
    store256(to.column + n, column);
    __m256i first = time, last = time;
    if constexpr (delayed) {
      const __m256i delay = _mm256_permutevar8x32_epi32(load256(in.delay + i), order);
      first = _mm256_add_epi64(time, _mm256_cvtepu32_epi64(_mm256_castsi256_si128(delay)));
      last = _mm256_add_epi64(time, _mm256_cvtepu32_epi64(_mm256_extracti128_si256(delay, 1)));
    }
    store256(to.time + n, first);
    store256(to.time + n + 4, last);
    n += static_cast<std::size_t>(_mm_popcnt_u32(kept));
  };
  int i = 0;
  for (; i + 8 <= in.beams; i += 8) eight(i, 0xff);
  if (i < in.beams) eight(i, (1u << (in.beams - i)) - 1);
  return n;
}

}  // namespace

std::size_t write_returns_avx2(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out,
                               std::size_t at) {
  return names.delay ? write_eights<true>(beams, names, out, at) : write_eights<false>(beams, names, out, at);
}

}  // namespace ca2::detail
#endif
