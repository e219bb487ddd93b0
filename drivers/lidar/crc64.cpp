#include "drivers/lidar/crc64.h"

#include <array>

#include "drivers/lidar/bytes.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace ca2 {
namespace {

constexpr std::uint64_t polynomial = 0xC96C5795D7870F42u;

/// tables[k][b]: the remainder of byte b followed by k zero bytes, so that eight bytes go in one step
/// ("slicing by 8").
constexpr std::array<std::array<std::uint64_t, 256>, 8> make_tables() {
  std::array<std::array<std::uint64_t, 256>, 8> tables{};
  for (unsigned b = 0; b < 256; ++b) {
    std::uint64_t value = b;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) != 0 ? polynomial : 0);
    tables[0][b] = value;
  }
  for (unsigned k = 1; k < 8; ++k) {
    for (unsigned b = 0; b < 256; ++b) {
      tables[k][b] = (tables[k - 1][b] >> 8) ^ tables[0][tables[k - 1][b] & 0xFF];
    }
  }
  return tables;
}
constexpr auto tables = make_tables();

/// The remainder's register after more bytes.
std::uint64_t advance(std::uint64_t crc, const std::uint8_t* bytes, std::size_t size) {
  std::size_t i = 0;
  for (; i + 8 <= size; i += 8) {
    crc ^= load<std::uint64_t>(bytes + i);
    crc = tables[7][crc & 0xFF] ^ tables[6][crc >> 8 & 0xFF] ^ tables[5][crc >> 16 & 0xFF] ^
          tables[4][crc >> 24 & 0xFF] ^ tables[3][crc >> 32 & 0xFF] ^ tables[2][crc >> 40 & 0xFF] ^
          tables[1][crc >> 48 & 0xFF] ^ tables[0][crc >> 56];
  }
  for (; i < size; ++i) crc = (crc >> 8) ^ tables[0][(crc ^ bytes[i]) & 0xFF];
  return crc;
}

#if defined(__x86_64__)
/// x^n modulo the polynomial, lowest power in the highest bit as everywhere here.
constexpr std::uint64_t power(int n) {
  std::uint64_t value = std::uint64_t{1} << 63;
  for (int i = 0; i < n; ++i) value = (value >> 1) ^ ((value & 1) != 0 ? polynomial : 0);
  return value;
}

// Carry-less multiplication folds what was read onto what comes some bytes later (Gopal et al., "Fast CRC
// Computation for Generic Polynomials Using PCLMULQDQ Instruction", Intel 2009). The products of bit-reversed
// factors are one power too high, hence the odd exponents. Loops over registers are unrolled: else these are
// kept in memory, and the time it takes there and back is what a step takes.

/// What 16 bytes become so many bits later.
template <int bits>
__attribute__((target("pclmul,sse4.1"))) inline __m128i fold(__m128i value) {
  constexpr std::uint64_t lower = power(bits + 64 - 1), upper = power(bits - 1);
  const __m128i factors = _mm_set_epi64x(static_cast<long long>(upper), static_cast<long long>(lower));
  return _mm_xor_si128(_mm_clmulepi64_si128(value, factors, 0x00),
                       _mm_clmulepi64_si128(value, factors, 0x11));
}

/// 64 bytes at a time, of at least as many.
__attribute__((target("pclmul,sse4.1"))) std::uint64_t advance_folding(std::uint64_t crc,
                                                                       const std::uint8_t* bytes,
                                                                       std::size_t size) {
  __m128i folded[4], block[4];
  std::memcpy(folded, bytes, sizeof folded);
  folded[0] = _mm_xor_si128(folded[0], _mm_set_epi64x(0, static_cast<long long>(crc)));
  std::size_t i = sizeof folded;
  for (; i + sizeof folded <= size; i += sizeof folded) {
    std::memcpy(block, bytes + i, sizeof block);
#pragma GCC unroll 4
    for (std::size_t k = 0; k < 4; ++k) folded[k] = _mm_xor_si128(fold<512>(folded[k]), block[k]);
  }
  __m128i last = _mm_xor_si128(_mm_xor_si128(fold<384>(folded[0]), fold<256>(folded[1])),
                               _mm_xor_si128(fold<128>(folded[2]), folded[3]));
  for (; i + sizeof last <= size; i += sizeof last) {
    std::memcpy(block, bytes + i, sizeof last);
    last = _mm_xor_si128(fold<128>(last), block[0]);
  }
  // What is left has the remainder of all that was folded.
  std::uint8_t rest[sizeof last];
  std::memcpy(rest, &last, sizeof rest);
  return advance(advance(0, rest, sizeof rest), bytes + i, size - i);
}

/// What is left of wider registers, and the bytes that did not fill them any more.
template <std::size_t most>
std::uint64_t advance_rest(const void* folded, const std::uint8_t* bytes, std::size_t size) {
  std::uint8_t rest[2 * most];
  std::memcpy(rest, folded, most);
  std::memcpy(rest + most, bytes, size);
  return advance_folding(0, rest, most + size);
}

/// The same, 128 bytes at a time.
__attribute__((target("vpclmulqdq,avx2,pclmul,sse4.1"))) std::uint64_t advance_folding_wide(
    std::uint64_t crc, const std::uint8_t* bytes, std::size_t size) {
  constexpr std::uint64_t lower = power(1024 + 64 - 1), upper = power(1024 - 1);
  const __m256i factors = _mm256_set_epi64x(static_cast<long long>(upper), static_cast<long long>(lower),
                                            static_cast<long long>(upper), static_cast<long long>(lower));
  __m256i folded[4];
  std::memcpy(folded, bytes, sizeof folded);
  folded[0] = _mm256_xor_si256(folded[0], _mm256_set_epi64x(0, 0, 0, static_cast<long long>(crc)));
  std::size_t i = sizeof folded;
  for (; i + sizeof folded <= size; i += sizeof folded) {
#pragma GCC unroll 4
    for (std::size_t k = 0; k < 4; ++k) {
      __m256i block;
      std::memcpy(&block, bytes + i + 32 * k, sizeof block);
      const __m256i product = _mm256_xor_si256(_mm256_clmulepi64_epi128(folded[k], factors, 0x00),
                                               _mm256_clmulepi64_epi128(folded[k], factors, 0x11));
      folded[k] = _mm256_xor_si256(product, block);
    }
  }
  return advance_rest<sizeof folded>(folded, bytes + i, size - i);
}

/// The same, 256 bytes at a time: the multiplier takes as long for registers of any width.
__attribute__((target("vpclmulqdq,avx512f,avx2,pclmul,sse4.1"))) std::uint64_t advance_folding_widest(
    std::uint64_t crc, const std::uint8_t* bytes, std::size_t size) {
  constexpr std::uint64_t lower = power(2048 + 64 - 1), upper = power(2048 - 1);
  const auto low = static_cast<long long>(lower), high = static_cast<long long>(upper);
  const __m512i factors = _mm512_set4_epi64(high, low, high, low);
  __m512i folded[4];
  std::memcpy(folded, bytes, sizeof folded);
  folded[0] =
      _mm512_xor_si512(folded[0], _mm512_zextsi128_si512(_mm_set_epi64x(0, static_cast<long long>(crc))));
  std::size_t i = sizeof folded;
  for (; i + sizeof folded <= size; i += sizeof folded) {
#pragma GCC unroll 4
    for (std::size_t k = 0; k < 4; ++k) {
      __m512i block;
      std::memcpy(&block, bytes + i + 64 * k, sizeof block);
      const __m512i product = _mm512_xor_si512(_mm512_clmulepi64_epi128(folded[k], factors, 0x00),
                                               _mm512_clmulepi64_epi128(folded[k], factors, 0x11));
      folded[k] = _mm512_xor_si512(product, block);
    }
  }
  return advance_rest<sizeof folded>(folded, bytes + i, size - i);
}
#endif

}  // namespace

std::uint64_t crc64(std::span<const std::uint8_t> bytes) {
  constexpr std::uint64_t first = ~std::uint64_t{0};
#if defined(__x86_64__)
  static const bool folding = __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("sse4.1");
  static const bool wide = folding && __builtin_cpu_supports("vpclmulqdq") && __builtin_cpu_supports("avx2");
  static const bool widest = wide && __builtin_cpu_supports("avx512f");
  if (widest && bytes.size() >= 512) return ~advance_folding_widest(first, bytes.data(), bytes.size());
  if (wide && bytes.size() >= 256) return ~advance_folding_wide(first, bytes.data(), bytes.size());
  if (folding && bytes.size() >= 64) return ~advance_folding(first, bytes.data(), bytes.size());
#endif
  return ~advance(first, bytes.data(), bytes.size());
}

}  // namespace ca2
