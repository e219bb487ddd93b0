/// @file The words of eight pixels that lie one after the other, and their fields, with AVX2.
#pragma once

#if defined(__x86_64__)
#include <immintrin.h>

#include <array>
#include <cstdint>

namespace ca2 {

/// Pixels of `size` words of 32 bits.
template <int size>
class PixelWords {
 public:
  __attribute__((target("avx2"))) explicit PixelWords(const std::uint8_t* pixels) {
#pragma GCC unroll 8
    for (int i = 0; i < size; ++i) {
      lanes_[i] = _mm256_loadu_si256(static_cast<const __m256i*>(static_cast<const void*>(pixels + 32 * i)));
    }
  }

  /// This word of each pixel.
  template <int index>
  __attribute__((target("avx2"))) __m256i word() const {
    if constexpr (size == 1) {
      return lanes_[0];
    } else if constexpr (size % 2 == 1) {
      // No two of the words share a place, so they go into one register before they are put in order.
      return _mm256_permutevar8x32_epi32(blended<index>(lanes_), order<index>());
    } else {
      __m256i in_order[size];
#pragma GCC unroll 8
      for (int i = 0; i < size; ++i) in_order[i] = _mm256_permutevar8x32_epi32(lanes_[i], order<index>());
      return blended<index>(in_order);
    }
  }

 private:
  /// Where pixels' word is in the register it is in.
  template <int index>
  __attribute__((target("avx2"))) static __m256i order() {
    constexpr auto at = [](int pixel) { return (pixel * size + index) % 8; };
    return _mm256_setr_epi32(at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7));
  }

  /// Of which places a register has what is wanted: before (`size` odd) or after they are put in order.
  template <int index>
  static constexpr int places(int lanes) {
    int out = 0;
    for (int pixel = 0; pixel < 8; ++pixel) {
      const int at = pixel * size + index;
      if (at / 8 == lanes) out |= 1 << (size % 2 == 1 ? at % 8 : pixel);
    }
    return out;
  }

  template <int index, int lanes = size - 1>
  __attribute__((target("avx2"))) static __m256i blended(const __m256i* registers) {
    if constexpr (lanes == 0) {
      return registers[0];
    } else {
      constexpr int here = places<index>(lanes);
      const __m256i others = blended<index, lanes - 1>(registers);
      return _mm256_blend_epi32(others, registers[lanes], here);
    }
  }

  __m256i lanes_[size];
};

/// Bits of words as numbers of 32 bits, times a power of two.
template <int bit, int width, int shift>
__attribute__((target("avx2"))) inline __m256i field_of(__m256i words) {
  if constexpr (bit > 0) words = _mm256_srli_epi32(words, bit);
  if constexpr (bit + width < 32) words = _mm256_and_si256(words, _mm256_set1_epi32((1 << width) - 1));
  if constexpr (shift > 0) words = _mm256_slli_epi32(words, shift);
  return words;
}

template <int bit, int width, int shift>
__attribute__((target("avx2"))) inline void store_field(__m256i words, std::uint32_t* out) {
  _mm256_storeu_si256(static_cast<__m256i*>(static_cast<void*>(out)), field_of<bit, width, shift>(words));
}

template <int bit, int width, int shift>
__attribute__((target("avx2"))) inline void store_field(__m256i words, std::uint16_t* out) {
  static_assert(width + shift <= 16);
  const __m256i fields = field_of<bit, width, shift>(words);
  const __m256i narrow = _mm256_permute4x64_epi64(_mm256_packus_epi32(fields, fields), 0b1000);
  _mm_storeu_si128(static_cast<__m128i*>(static_cast<void*>(out)), _mm256_castsi256_si128(narrow));
}

template <int bit, int width, int shift>
__attribute__((target("avx2"))) inline void store_field(__m256i words, std::uint8_t* out) {
  static_assert(bit % 8 == 0 && width == 8 && shift == 0);
  constexpr int byte = bit / 8;
  constexpr int each = byte | (byte + 4) << 8 | (byte + 8) << 16 | (byte + 12) << 24;
  const __m256i halves = _mm256_shuffle_epi8(words, _mm256_set1_epi32(each));
  const __m256i bytes = _mm256_permutevar8x32_epi32(halves, _mm256_setr_epi32(0, 4, 0, 4, 0, 4, 0, 4));
  _mm_storel_epi64(static_cast<__m128i*>(static_cast<void*>(out)), _mm256_castsi256_si128(bytes));
}

}  // namespace ca2
#endif
