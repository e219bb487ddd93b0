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
    out.points[3 * n] = beams.x[i];
    out.points[3 * n + 1] = beams.y[i];
    out.points[3 * n + 2] = beams.z[i];
    out.range[n] = beams.range[i];
    out.intensity[n] = names.intensity[i];
    out.ring[n] = names.ring[i];
    out.column[n] = names.column;
    out.time[n] = names.time + names.delay[i];
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

}  // namespace

__attribute__((target("avx2,popcnt"))) std::size_t write_returns_avx2(const FiredBeams& beams,
                                                                      const FiredNames& names,
                                                                      const ReturnTargets& out) {
  const __m256i zero = _mm256_setzero_si256(), time = _mm256_set1_epi64x(names.time);
  const __m256i column = _mm256_set1_epi32(static_cast<int>(names.column));
  std::size_t n = 0;
  for (int i = 0; i < names.beams; i += 8) {
    const auto counts =
        _mm256_loadu_si256(static_cast<const __m256i*>(static_cast<const void*>(names.counts + i)));
    auto kept =
        ~static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(counts, zero))));
    kept &= (1u << std::min(names.beams - i, 8)) - 1;
    const __m256i order = bytes_at(orders[kept].data());
    const auto packed = [&](const float* from) __attribute__((target("avx2"))) {
      return _mm256_permutevar8x32_ps(_mm256_load_ps(from + i), order);
    };
    store_points(out.points + 3 * n, packed(beams.x), packed(beams.y), packed(beams.z));
    _mm256_storeu_ps(out.range + n, packed(beams.range));
    const __m256i intensity = _mm256_permutevar8x32_epi32(bytes_at(names.intensity + i), order);
    _mm256_storeu_ps(out.intensity + n, _mm256_cvtepi32_ps(intensity));
    const __m256i ring = _mm256_permutevar8x32_epi32(_mm256_cvtepu16_epi32(load128(names.ring + i)), order);
    const __m256i narrow = _mm256_permute4x64_epi64(_mm256_packus_epi32(ring, zero), 0b1000);
    _mm_storeu_si128(static_cast<__m128i*>(static_cast<void*>(out.ring + n)), _mm256_castsi256_si128(narrow));
    store256(out.column + n, column);
    const __m256i delay = _mm256_permutevar8x32_epi32(
        _mm256_loadu_si256(static_cast<const __m256i*>(static_cast<const void*>(names.delay + i))), order);
    store256(out.time + n, _mm256_add_epi64(time, _mm256_cvtepu32_epi64(_mm256_castsi256_si128(delay))));
    store256(out.time + n + 4,
             _mm256_add_epi64(time, _mm256_cvtepu32_epi64(_mm256_extracti128_si256(delay, 1))));
    n += static_cast<std::size_t>(_mm_popcnt_u32(kept));
  }
  return n;
}
#endif

}  // namespace detail

namespace {

constexpr std::size_t spare = 8;  // written beyond the last return

}  // namespace

void ReturnWriter::begin(Scan& scan, std::size_t expected) {
  scan_ = &scan;
  expected_ = expected;
  size_ = 0;
  room_ = std::min({scan.points.size(), scan.intensity.size(), scan.range.size(), scan.ring.size(),
                    scan.column.size(), scan.time.size()});
}

void ReturnWriter::resize(std::size_t returns) {
  scan_->points.resize(returns);
  scan_->intensity.resize(returns);
  scan_->range.resize(returns);
  scan_->ring.resize(returns);
  scan_->column.resize(returns);
  scan_->time.resize(returns);
  room_ = returns;
}

void ReturnWriter::add(const FiredBeams& beams, const FiredNames& names) {
  const std::size_t needed = size_ + static_cast<std::size_t>(names.beams) + spare;
  // Not more than expected, lest the arrays move: their memory is what takes time.
  if (needed > room_) resize(needed <= expected_ + spare ? expected_ + spare : needed + needed / 4);
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
