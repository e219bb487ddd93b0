#include "drivers/lidar/ouster/profile.h"

#include <array>
#include <utility>

#include "drivers/lidar/avx512.h"
#include "drivers/lidar/bytes.h"
#include "drivers/lidar/ouster/pixel_words.h"
#include "drivers/lidar/ouster/sixteen_pixel_words.h"

namespace ca2 {
namespace {

constexpr OusterField none{};
constexpr OusterField rng19{0, 19, 0}, rng19_second{32, 19, 0};
constexpr OusterField rng15{0, 15, 3}, rng15_second{32, 15, 3};

// Ouster Firmware User Manual, "Lidar Data Packet Format"; those of firmware 3.2 from the vendor's library.
constexpr std::array layouts{
    OusterProfile{"LEGACY", 12, {{0, 20, 0}, none}, {{32, 8, 0}, none}, {{48, 16, 0}, none}, {64, 16, 0}},
    OusterProfile{
        "RNG19_RFL8_SIG16_NIR16", 12, {rng19, none}, {{32, 8, 0}, none}, {{48, 16, 0}, none}, {64, 16, 0}},
    OusterProfile{"RNG19_RFL8_SIG16_NIR16_DUAL",
                  16,
                  {rng19, rng19_second},
                  {{24, 8, 0}, {56, 8, 0}},
                  {{64, 16, 0}, {80, 16, 0}},
                  {96, 16, 0}},
    OusterProfile{"RNG15_RFL8_NIR8", 4, {rng15, none}, {{16, 8, 0}, none}, {none, none}, {24, 8, 4}},
    OusterProfile{"FIVE_WORD_PIXEL",
                  20,
                  {rng19, rng19_second},
                  {{24, 8, 0}, {56, 8, 0}},
                  {{64, 16, 0}, {80, 16, 0}},
                  {96, 16, 0}},
    OusterProfile{"FUSA_RNG15_RFL8_NIR8_DUAL",
                  8,
                  {rng15, rng15_second},
                  {{16, 8, 0}, {48, 8, 0}},
                  {none, none},
                  {24, 8, 4}},
    OusterProfile{
        "RNG15_RFL8_NIR8_DUAL", 8, {rng15, rng15_second}, {{16, 8, 0}, {48, 8, 0}}, {none, none}, {24, 8, 4}},
    OusterProfile{"RNG15_RFL8_NIR8_ZONE16", 8, {rng15, none}, {{16, 8, 0}, none}, {none, none}, {24, 8, 4}},
    OusterProfile{"RNG19_RFL8_SIG16_NIR16_ZONE16",
                  12,
                  {rng19, none},
                  {{32, 8, 0}, none},
                  {{48, 16, 0}, none},
                  {64, 16, 0}},
    OusterProfile{"RNG15_RFL8_WIN8", 4, {rng15, none}, {{16, 8, 0}, none}, {none, none}, none},
    OusterProfile{"RNG19_RFL8_SIG16_ZONE16_DUAL",
                  16,
                  {rng19, rng19_second},
                  {{24, 8, 0}, {56, 8, 0}},
                  {{64, 16, 0}, {80, 16, 0}},
                  none},
    OusterProfile{"RNG19_RFL8_SIG16_NIR16_RGB16",
                  16,
                  {rng19, none},
                  {{24, 8, 0}, none},
                  {{32, 16, 0}, none},
                  {48, 16, 0}},
    OusterProfile{"RNG19_RFL8_SIG16_NIR16_RGB16_DUAL",
                  20,
                  {rng19, rng19_second},
                  {{24, 8, 0}, {56, 8, 0}},
                  {{64, 16, 0}, {80, 16, 0}},
                  {96, 16, 0}},
};

/// A field of a column from row `first` on. Everything about it is known to the compiler, and what is written
/// might otherwise alias what is read.
template <int stride, int bit, int width, int shift, class T>
void decode_field(const std::uint8_t* pixels, int first, int rows, T* __restrict out) {
  if (!out) return;
  const std::uint8_t* at = pixels + bit / 8 + first * stride;
  for (int row = first; row < rows; ++row, at += stride) {
    // Fields of one or two whole bytes are read as such.
    if constexpr (width == 8 && bit % 8 == 0) {
      out[row] = static_cast<T>(static_cast<unsigned>(*at) << shift);
    } else if constexpr (width == 16 && bit % 8 == 0) {
      out[row] = static_cast<T>(load<std::uint16_t>(at) << shift);
    } else {
      constexpr std::uint32_t mask = (1u << width) - 1;
      out[row] = static_cast<T>((load<std::uint32_t>(at) >> bit % 8 & mask) << shift);
    }
  }
}

template <std::size_t index>
void decode_rows(const std::uint8_t* pixels, int first, int rows, const OusterPixels& out) {
  constexpr OusterProfile p = layouts[index];
  constexpr int stride = p.pixel_bytes;
  const auto all = [&]<int i>() {
    constexpr OusterField range = p.range[i], reflectivity = p.reflectivity[i], signal = p.signal[i];
    decode_field<stride, range.bit, range.width, range.shift>(pixels, first, rows, out.range[i]);
    decode_field<stride, reflectivity.bit, 8, reflectivity.shift>(pixels, first, rows, out.reflectivity[i]);
    if constexpr (signal.present())
      decode_field<stride, signal.bit, signal.width, signal.shift>(pixels, first, rows, out.signal[i]);
  };
  all.template operator()<0>();
  if constexpr (p.dual()) all.template operator()<1>();
  if constexpr (p.near_ir.present())
    decode_field<stride, p.near_ir.bit, p.near_ir.width, p.near_ir.shift>(pixels, first, rows, out.near_ir);
}

template <std::size_t index>
void decode_column_portable(const std::uint8_t* pixels, int rows, const OusterPixels& out) {
  decode_rows<index>(pixels, 0, rows, out);
}

#if defined(__x86_64__)
template <std::size_t index, OusterField field, class T>
__attribute__((target("avx2"))) inline void decode_eight(
    const PixelWords<layouts[index].pixel_bytes / 4>& words, int row, T* out) {
  static_assert(field.bit % 32 + field.width <= 32);
  if (out)
    store_field<field.bit % 32, field.width, field.shift>(words.template word<field.bit / 32>(), out + row);
}

/// Eight pixels at a time.
template <std::size_t index>
__attribute__((target("avx2"))) void decode_column_avx2(const std::uint8_t* pixels, int rows,
                                                        const OusterPixels& out) {
  constexpr OusterProfile p = layouts[index];
  int row = 0;
  for (; row + 8 <= rows; row += 8) {
    const PixelWords<p.pixel_bytes / 4> words(pixels + row * p.pixel_bytes);
    decode_eight<index, p.range[0]>(words, row, out.range[0]);
    decode_eight<index, p.reflectivity[0]>(words, row, out.reflectivity[0]);
    if constexpr (p.signal[0].present()) decode_eight<index, p.signal[0]>(words, row, out.signal[0]);
    if constexpr (p.dual()) {
      decode_eight<index, p.range[1]>(words, row, out.range[1]);
      decode_eight<index, p.reflectivity[1]>(words, row, out.reflectivity[1]);
      if constexpr (p.signal[1].present()) decode_eight<index, p.signal[1]>(words, row, out.signal[1]);
    }
    if constexpr (p.near_ir.present()) decode_eight<index, p.near_ir>(words, row, out.near_ir);
  }
  decode_rows<index>(pixels, row, rows, out);
}

template <std::size_t index, OusterField field, class T>
CA2_AVX512 inline void decode_sixteen(const SixteenPixelWords<layouts[index].pixel_bytes / 4>& words, int row,
                                      T* out) {
  if (out) {
    store_sixteen<field.bit % 32, field.width, field.shift>(words.template word<field.bit / 32>(), out + row);
  }
}

/// Sixteen pixels at a time.
template <std::size_t index>
CA2_AVX512 void decode_column_avx512(const std::uint8_t* pixels, int rows, const OusterPixels& out) {
  const OusterPixels to = out;  // which what is written cannot change
  constexpr OusterProfile p = layouts[index];
  int row = 0;
  for (; row + 16 <= rows; row += 16) {
    const SixteenPixelWords<p.pixel_bytes / 4> words(pixels + row * p.pixel_bytes);
    decode_sixteen<index, p.range[0]>(words, row, to.range[0]);
    decode_sixteen<index, p.reflectivity[0]>(words, row, to.reflectivity[0]);
    if constexpr (p.signal[0].present()) decode_sixteen<index, p.signal[0]>(words, row, to.signal[0]);
    if constexpr (p.dual()) {
      decode_sixteen<index, p.range[1]>(words, row, to.range[1]);
      decode_sixteen<index, p.reflectivity[1]>(words, row, to.reflectivity[1]);
      if constexpr (p.signal[1].present()) decode_sixteen<index, p.signal[1]>(words, row, to.signal[1]);
    }
    if constexpr (p.near_ir.present()) decode_sixteen<index, p.near_ir>(words, row, to.near_ir);
  }
  decode_rows<index>(pixels, row, rows, out);
}
#endif

template <std::size_t index>
void decode_column(const std::uint8_t* pixels, int rows, const OusterPixels& out) {
#if defined(__x86_64__)
  static const bool avx2 = __builtin_cpu_supports("avx2");
  if (has_avx512()) return decode_column_avx512<index>(pixels, rows, out);
  if (avx2) return decode_column_avx2<index>(pixels, rows, out);
#endif
  decode_column_portable<index>(pixels, rows, out);
}

template <std::size_t... index>
constexpr auto with_decoders(std::index_sequence<index...>) {
  auto out = layouts;
  ((out[index].decode = &decode_column<index>), ...);
  ((out[index].decode_portable = &decode_column_portable<index>), ...);
#if defined(__x86_64__)
  ((out[index].decode_avx2 = &decode_column_avx2<index>), ...);
#endif
  return out;
}
constexpr auto profiles = with_decoders(std::make_index_sequence<layouts.size()>());

}  // namespace

std::span<const OusterProfile> ouster_profiles() {
  return profiles;
}

const OusterProfile* find_ouster_profile(std::string_view name) {
  for (const OusterProfile& profile : profiles) {
    if (profile.name == name) return &profile;
  }
  return nullptr;
}

}  // namespace ca2
