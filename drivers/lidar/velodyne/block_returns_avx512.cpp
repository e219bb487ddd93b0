// Sixteen channels at a time, which stay in registers until they are written.
#include "drivers/lidar/velodyne/block_returns.h"
#include "drivers/lidar/write_sixteens.h"

#if defined(__x86_64__)
namespace ca2::detail {
namespace {

constexpr int channel_bytes = 3;

/// Sixteen channels as they are on the wire.
CA2_AVX512 inline SixteenBeams read_sixteen(const std::uint8_t* channels) {
  const __m512i of_counts = _mm512_maskz_broadcast_i32x4(
      0xffff, _mm_setr_epi8(0, 1, -1, -1, 3, 4, -1, -1, 6, 7, -1, -1, 9, 10, -1, -1));
  const __m512i of_intensity = _mm512_maskz_broadcast_i32x4(
      0xffff, _mm_setr_epi8(2, -1, -1, -1, 5, -1, -1, -1, 8, -1, -1, -1, 11, -1, -1, -1));
  const auto four = [&](int first) CA2_AVX512 {
    return _mm_loadu_si128(
        static_cast<const __m128i*>(static_cast<const void*>(channels + first * channel_bytes)));
  };
  __m512i all = _mm512_zextsi128_si512(four(0));
  all = _mm512_maskz_inserti32x4(0xffff, all, four(4), 1);
  all = _mm512_maskz_inserti32x4(0xffff, all, four(8), 2);
  all = _mm512_maskz_inserti32x4(0xffff, all, four(12), 3);
  return {_mm512_shuffle_epi8(all, of_counts), _mm512_shuffle_epi8(all, of_intensity)};
}

template <bool sideways>
CA2_AVX512 std::size_t write_channels(const std::uint8_t* block, const VelodyneBlockPlace& place,
                                      const FiredNames& names, const ReturnTargets& out, std::size_t at) {
  const auto channel = static_cast<std::size_t>(names.first);
  const VelodyneProjection::Bank& bank = place.bank;
  const float *const
      turn_sine_of = &place.turned.sine[channel],
      *const turn_cosine_of = &place.turned.cosine[channel], *const distance_of = &bank.distance[channel],
      *const cos_of = &bank.cos_vertical[channel], *const sin_of = &bank.sin_vertical[channel],
      *const v_of = &bank.vertical_offset[channel], *const h_of = &bank.horizontal_offset[channel];
  const __m512 head_sine = _mm512_set1_ps(place.sine), head_cosine = _mm512_set1_ps(place.cosine);
  const __m512 lsb = _mm512_set1_ps(place.lsb);
  const auto places = [&](int i, __mmask16 here, __m512i counts) CA2_AVX512 {
    const auto of = [&](const float* from) CA2_AVX512 { return _mm512_maskz_loadu_ps(here, from + i); };
    const __m512 turn_sine = of(turn_sine_of), turn_cosine = of(turn_cosine_of);
    const __m512 sine = head_sine * turn_cosine + head_cosine * turn_sine;
    const __m512 cosine = head_cosine * turn_cosine - head_sine * turn_sine;
    const __m512 range = _mm512_maskz_cvtepi32_ps(0xffff, counts) * lsb + of(distance_of);
    const __m512 flat = range * of(cos_of);
    __m512 x = flat * sine, y = flat * cosine;
    if constexpr (sideways) {
      const __m512 h = of(h_of);
      x = x - h * cosine;
      y = y + h * sine;
    }
    return SixteenPlaces{x, y, range * of(sin_of) + of(v_of), range};
  };
  const std::uint8_t* const channels = block + 4 + names.first * channel_bytes;
  const auto beams = [&](int i, __mmask16) CA2_AVX512 { return read_sixteen(channels + i * channel_bytes); };
  return write_sixteens<true>(names, out, at, beams, places);
}

}  // namespace

CA2_AVX512 std::size_t write_velodyne_block_avx512(const std::uint8_t* block, const VelodyneBlockPlace& place,
                                                   const FiredNames& names, const ReturnTargets& out,
                                                   std::size_t at) {
  return place.sideways ? write_channels<true>(block, place, names, out, at)
                        : write_channels<false>(block, place, names, out, at);
}

}  // namespace ca2::detail
#endif
