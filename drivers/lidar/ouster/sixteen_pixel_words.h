/// @file The words of sixteen pixels that lie one after the other, and their fields, with AVX-512.
#pragma once

#include "drivers/lidar/avx512.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <array>
#include <cstdint>

namespace ca2 {

/// As PixelWords: pixels of `size` words of 32 bits.
template <int size>
class SixteenPixelWords {
 public:
  CA2_AVX512 explicit SixteenPixelWords(const std::uint8_t* pixels) {
#pragma GCC unroll 8
    for (int i = 0; i < size; ++i) lanes_[i] = _mm512_loadu_si512(pixels + 64 * i);
  }

  /// This word of each pixel.
  template <int index>
  CA2_AVX512 __m512i word() const {
    if constexpr (size == 1) {
      return lanes_[0];
    } else if constexpr (size % 2 == 1) {
      // No two of the words share a place, so they go into one register before they are put in order.
      return _mm512_maskz_permutexvar_epi32(0xffff, _mm512_load_si512(order<index>.data()), blended<index>());
    } else {
      return gathered<index>();
    }
  }

 private:
  using Lanes = std::array<int, 16>;

  /// Where pixels' word is in the register it is in.
  template <int index>
  alignas(64) static constexpr Lanes order = [] {
    Lanes out{};
    for (int pixel = 0; pixel < 16; ++pixel)
      out[static_cast<std::size_t>(pixel)] = (pixel * size + index) % 16;
    return out;
  }();
  /// The same where the word is in this register, as the second of two; of the first what is there already.
  template <int index, int lanes>
  alignas(64) static constexpr Lanes added = [] {
    Lanes out{};
    for (int pixel = 0; pixel < 16; ++pixel) {
      const int at = pixel * size + index;
      const int before = lanes == 1 ? at % 16 : pixel;  // the first register is not in order yet
      out[static_cast<std::size_t>(pixel)] = at / 16 == lanes ? 16 + at % 16 : before;
    }
    return out;
  }();
  /// Which places of a register have what is wanted.
  template <int index>
  static constexpr __mmask16 places(int lanes) {
    unsigned out = 0;
    for (int pixel = 0; pixel < 16; ++pixel) {
      const int at = pixel * size + index;
      if (at / 16 == lanes) out |= 1u << at % 16;
    }
    return static_cast<__mmask16>(out);
  }

  template <int index, int lanes = size - 1>
  CA2_AVX512 __m512i blended() const {
    if constexpr (lanes == 0) {
      return lanes_[0];
    } else {
      return _mm512_mask_blend_epi32(places<index>(lanes), blended<index, lanes - 1>(), lanes_[lanes]);
    }
  }

  template <int index, int lanes = size - 1>
  CA2_AVX512 __m512i gathered() const {
    if constexpr (lanes == 0) {
      return lanes_[0];
    } else {
      const __m512i at = _mm512_load_si512(added<index, lanes>.data());
      return _mm512_permutex2var_epi32(gathered<index, lanes - 1>(), at, lanes_[lanes]);
    }
  }

  __m512i lanes_[size];
};

/// Bits of words times a power of two, as numbers of this many bits.
template <int bit, int width, int shift, int wanted>
CA2_AVX512 inline __m512i sixteen_fields(__m512i words) {
  if constexpr (bit > 0) words = _mm512_maskz_srli_epi32(0xffff, words, bit);
  constexpr bool cut_off = width + shift >= wanted || bit + width == 32;  // as the shift, or to `wanted` bits
  if constexpr (!cut_off) words = _mm512_and_si512(words, _mm512_set1_epi32((1 << width) - 1));
  if constexpr (shift > 0) words = _mm512_maskz_slli_epi32(0xffff, words, shift);
  return words;
}

template <int bit, int width, int shift>
CA2_AVX512 inline void store_sixteen(__m512i words, std::uint32_t* out) {
  _mm512_storeu_si512(out, sixteen_fields<bit, width, shift, 32>(words));
}

template <int bit, int width, int shift>
CA2_AVX512 inline void store_sixteen(__m512i words, std::uint16_t* out) {
  const __m512i fields = sixteen_fields<bit, width, shift, 16>(words);
  _mm256_storeu_epi16(out, _mm512_maskz_cvtepi32_epi16(0xffff, fields));
}

template <int bit, int width, int shift>
CA2_AVX512 inline void store_sixteen(__m512i words, std::uint8_t* out) {
  const __m512i fields = sixteen_fields<bit, width, shift, 8>(words);
  _mm_storeu_epi8(out, _mm512_maskz_cvtepi32_epi8(0xffff, fields));
}

}  // namespace ca2
#endif
