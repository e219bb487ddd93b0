/// @file The Ouster lidar packet formats ("udp_profile_lidar"): where each field of a pixel lies, as data.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace ca2 {

/// Bits `bit` to `bit + width` of a pixel, little-endian from its first byte; value = bits << `shift`.
struct OusterField {
  int bit = 0;
  int width = 0;  ///< 0: the profile has no such field
  int shift = 0;  ///< low data rate profiles count ranges in 8 mm and near infrared in 16

  constexpr bool present() const { return width > 0; }
};

/// Where the fields of a column go, by row; nullptr: not wanted, or not in the profile.
struct OusterPixels {
  std::uint32_t* range[2] = {};  ///< mm
  std::uint8_t* reflectivity[2] = {};
  std::uint16_t* signal[2] = {};
  std::uint16_t* near_ir = nullptr;
};
/// `pixels` is the column's first pixel on the wire. May read up to three bytes beyond the last one, which
/// are of the column's or packet's footer.
using OusterColumnDecoder = void (*)(const std::uint8_t* pixels, int rows, const OusterPixels& out);

/// The fields Ca2 decodes. `range`, `reflectivity` and `signal` have a second return in dual profiles.
struct OusterProfile {
  std::string_view name;  ///< as metadata spells it
  int pixel_bytes = 0;
  OusterField range[2];         ///< mm
  OusterField reflectivity[2];  ///< 0-255, calibrated
  OusterField signal[2];        ///< photons
  OusterField near_ir;          ///< photons
  OusterColumnDecoder decode = nullptr;
  // The same numbers.
  OusterColumnDecoder decode_portable = nullptr;  ///< on any processor
  OusterColumnDecoder decode_avx2 = nullptr;      ///< where it has AVX2; nullptr: not a kind that may

  constexpr bool legacy() const { return name == "LEGACY"; }
  constexpr bool dual() const { return range[1].present(); }
  /// Sizes of the frame around the pixels, in bytes.
  int packet_header() const { return legacy() ? 0 : 32; }
  int packet_footer() const { return legacy() ? 0 : 32; }
  int column_header() const { return legacy() ? 16 : 12; }
  int column_footer() const { return legacy() ? 4 : 0; }
  /// mm: the step of the range field.
  int range_step() const { return 1 << range[0].shift; }
};

std::span<const OusterProfile> ouster_profiles();

/// nullptr when there is no profile of that name ("OFF" is none: such a sensor sends no lidar packets).
const OusterProfile* find_ouster_profile(std::string_view name);

}  // namespace ca2
