#include "drivers/lidar/return_writer.h"

#include <algorithm>
#include <array>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace ca2 {
namespace detail {

/// Every beam is written and counted if it is a return: cheaper than a branch taken at random.
std::size_t write_returns_portable(const FiredBeams& beams, const FiredNames& names,
                                   const ReturnTargets& out) {
  std::size_t n = 0;
  for (int i = 0; i < names.beams; ++i) {
    const int beam = names.first + i;
    out.points[3 * n] = beams.x[beam];
    out.points[3 * n + 1] = beams.y[beam];
    out.points[3 * n + 2] = beams.z[beam];
    out.range[n] = beams.range[beam];
    out.intensity[n] = names.intensity[i];
    out.ring[n] = names.ring[i];
    out.column[n] = names.column;
    out.time[n] = names.time + (names.delay ? names.delay[i] : 0);
    n += names.counts[i] != 0;
  }
  return n;
}

#if defined(__x86_64__)
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
                                                                const ReturnTargets& out) {
  // In variables of their own, which what is written cannot change.
  const auto [counts, intensities, rings, delays, column_number, fired, beam_count, first_beam] = names;
  const auto [points_out, range_out, intensity_out, ring_out, column_out, time_out] = out;
  const __m256i zero = _mm256_setzero_si256(), time = _mm256_set1_epi64x(fired);
  const __m256i column = _mm256_set1_epi32(static_cast<int>(column_number));
  std::size_t n = 0;
  const auto eight = [&](int i, unsigned wanted) __attribute__((target("avx2,popcnt"), always_inline)) {
    const __m256i missing = _mm256_cmpeq_epi32(load256(counts + i), zero);
    const unsigned kept = ~static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(missing))) & wanted;
    const __m256i order = bytes_at(orders[kept].data());
    const auto packed = [&](const float* from) __attribute__((target("avx2"))) {
      return _mm256_permutevar8x32_ps(_mm256_load_ps(from + first_beam + i), order);
    };
    store_points(points_out + 3 * n, packed(beams.x), packed(beams.y), packed(beams.z));
    _mm256_storeu_ps(range_out + n, packed(beams.range));
    const __m256i intensity = _mm256_permutevar8x32_epi32(bytes_at(intensities + i), order);
    _mm256_storeu_ps(intensity_out + n, _mm256_cvtepi32_ps(intensity));
    const __m256i ring = _mm256_permutevar8x32_epi32(_mm256_cvtepu16_epi32(load128(rings + i)), order);
    const __m256i narrow = _mm256_permute4x64_epi64(_mm256_packus_epi32(ring, zero), 0b1000);
    _mm_storeu_si128(static_cast<__m128i*>(static_cast<void*>(ring_out + n)), _mm256_castsi256_si128(narrow));
    store256(column_out + n, column);
    __m256i first = time, last = time;
    if constexpr (delayed) {
      const __m256i delay = _mm256_permutevar8x32_epi32(load256(delays + i), order);
      first = _mm256_add_epi64(time, _mm256_cvtepu32_epi64(_mm256_castsi256_si128(delay)));
      last = _mm256_add_epi64(time, _mm256_cvtepu32_epi64(_mm256_extracti128_si256(delay, 1)));
    }
    store256(time_out + n, first);
    store256(time_out + n + 4, last);
    n += static_cast<std::size_t>(_mm_popcnt_u32(kept));
  };
  int i = 0;
  for (; i + 8 <= beam_count; i += 8) eight(i, 0xff);
  if (i < beam_count) eight(i, (1u << (beam_count - i)) - 1);
  return n;
}

}  // namespace

std::size_t write_returns_avx2(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out) {
  return names.delay ? write_eights<true>(beams, names, out) : write_eights<false>(beams, names, out);
}
#endif

}  // namespace detail

namespace {

constexpr std::size_t spare = 8;    // written beyond the last return
constexpr std::size_t step = 1024;  // returns for which room is made at a time

/// What `f` says of each of the arrays.
template <class F>
auto of_arrays(Scan& scan, F f) {
  return std::array{f(scan.points), f(scan.intensity), f(scan.range),
                    f(scan.ring),   f(scan.column),    f(scan.time)};
}

}  // namespace

void ReturnWriter::begin(Scan& scan, std::size_t expected) {
  scan_ = &scan;
  expected_ = expected;
  size_ = 0;
  const auto least = [](const auto& sizes) { return *std::min_element(sizes.begin(), sizes.end()); };
  room_ = least(of_arrays(scan, [](const auto& array) { return array.size(); }));
  memory_ = least(of_arrays(scan, [](const auto& array) { return array.capacity(); }));
}

void ReturnWriter::resize(std::size_t returns) {
  of_arrays(*scan_, [&](auto& array) { return array.resize(returns), 0; });
  room_ = returns;
}

/// A vector clears what it grows by: a little at a time, which is then in the cache when it is written.
void ReturnWriter::grow(std::size_t needed) {
  if (needed > memory_) {
    // Not more than expected, lest the arrays move: their memory is what takes time.
    memory_ = needed <= expected_ + spare ? expected_ + spare : needed + needed / 4;
    of_arrays(*scan_, [&](auto& array) { return array.reserve(memory_), 0; });
  }
  resize(std::min(needed + step, memory_));
}

void ReturnWriter::add(const FiredBeams& beams, const FiredNames& names) {
  const std::size_t needed = size_ + static_cast<std::size_t>(names.beams) + spare;
  if (needed > room_) grow(needed);
  const detail::ReturnTargets out{scan_->points.data()->data() + 3 * size_,
                                  scan_->range.data() + size_,
                                  scan_->intensity.data() + size_,
                                  scan_->ring.data() + size_,
                                  scan_->column.data() + size_,
                                  scan_->time.data() + size_};
#if defined(__x86_64__)
  static const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
  if (avx2) {
    size_ += detail::write_returns_avx2(beams, names, out);
    return;
  }
#endif
  size_ += detail::write_returns_portable(beams, names, out);
}

void ReturnWriter::finish() {
  resize(size_);
}

}  // namespace ca2
