#include "drivers/camera/pixel_formats/samples.h"

#include <bit>
#include <cstring>

#include "core/types/hot_loop.h"

static_assert(std::endian::native == std::endian::little, "samples are read as the processor's own words");

namespace ca2 {
namespace {

// Four samples at once: `x` holds their bytes from the low end; the answer holds the four words. Bits beyond
// the samples' bytes may be anything.

std::uint64_t spread_pfnc10(std::uint64_t x) {
  return (x << 6 & 0xffc0) | (x << 12 & 0xffc00000) | (x << 18 & 0xffc000000000) |
         (x << 24 & 0xffc0000000000000);
}

std::uint64_t spread_pfnc12(std::uint64_t x) {
  return (x << 4 & 0xfff0) | (x << 8 & 0xfff00000) | (x << 12 & 0xfff000000000) |
         (x << 16 & 0xfff0000000000000);
}

/// Two of three bytes: high A, low B and A, high B. `keep` are the low bits of A as they lie in a word.
std::uint64_t spread_gige(std::uint64_t x, int up, std::uint64_t keep) {
  return (x << 8 & 0xff00ff00) | (x >> 8 << up & keep) | (x >> 12 << up & keep) << 16;
}

std::uint64_t spread_gige10(std::uint64_t x) {
  return spread_gige(x & 0xffffff, 6, 0xc0) | spread_gige(x >> 24 & 0xffffff, 6, 0xc0) << 32;
}

std::uint64_t spread_gige12(std::uint64_t x) {
  return spread_gige(x & 0xffffff, 4, 0xf0) | spread_gige(x >> 24 & 0xffffff, 4, 0xf0) << 32;
}

template <std::size_t Bytes, std::uint64_t (*Spread)(std::uint64_t)>
void unpack_fours(const std::uint8_t* from, std::size_t count, std::uint16_t* to) {
  std::size_t i = 0;
  // Eight bytes are read where four samples take fewer: the last ones are copied out first.
  for (; i + 8 <= count; i += 4, from += Bytes) {
    std::uint64_t x = 0;
    std::memcpy(&x, from, 8);
    x = Spread(x);
    std::memcpy(to + i, &x, 8);
  }
  for (; i < count; i += 4, from += Bytes) {
    const std::size_t left = count - i < 4 ? count - i : 4;
    std::uint64_t x = 0;
    std::memcpy(&x, from, (left * Bytes + 3) / 4);
    x = Spread(x);
    std::memcpy(to + i, &x, 2 * left);
  }
}

}  // namespace

CA2_HOT_LOOP void widen_words(const std::uint8_t* from, std::size_t count, int bits, std::uint16_t* to) {
  const int up = 16 - bits;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint16_t word;
    std::memcpy(&word, from + 2 * i, 2);
    to[i] = static_cast<std::uint16_t>(word << up);
  }
}

void unpack_samples(PixelPacking packing, const std::uint8_t* from, std::size_t count, std::uint16_t* to) {
  switch (packing) {
    case PixelPacking::pfnc10:
      return unpack_fours<5, spread_pfnc10>(from, count, to);
    case PixelPacking::pfnc12:
      return unpack_fours<6, spread_pfnc12>(from, count, to);
    case PixelPacking::gige10:
      return unpack_fours<6, spread_gige10>(from, count, to);
    case PixelPacking::gige12:
      return unpack_fours<6, spread_gige12>(from, count, to);
    case PixelPacking::bytes:
    case PixelPacking::words:
    case PixelPacking::jpeg:
      break;
  }
}

}  // namespace ca2
