/// @file Messages of a T265, byte by byte, written out independently of the code that is tested. Intrinsics
/// and serial number are those of a real unit (published dumps); the pictures are cut to six pixels.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ca2::t265::golden {

/// Bodies of responses, without the header of eight bytes.
inline constexpr std::string_view device_info =
    "00 01 02 03 04 00 02 00 b7 03 00 00 07 00 00 00 00 00 00 00 00 00 00 00 90 84 12 11 09 93 00 00 00 00 "
    "00 00 "
    "00 00 00 00 00 00 00 00 01 00";
inline constexpr std::string_view intrinsics_left =
    "50 03 00 00 20 03 00 00 c7 bb d1 43 cd 7c c1 43 6a 1c 8f 43 71 bd 8f 43 04 00 00 00 ab 79 8e bb 6f 11 "
    "18 3d "
    "58 91 11 bd 6f 2b bd 3b 00 00 00 00";
inline constexpr std::string_view extrinsics_left =  // diag(1, -1, -1), t = (-0.032, 0.001, 0.002)
    "00 00 80 3f 00 00 00 00 00 00 00 00 00 00 00 00 00 00 80 bf 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
    "80 bf "
    "6f 12 03 bd 6f 12 83 3a 6f 12 03 3b 0a";
inline constexpr std::string_view streams =  // both fisheyes and the gyroscope
    "03 00 00 00 03 00 50 03 20 03 09 00 50 03 1e 00 23 00 50 03 20 03 09 00 50 03 1e 00 04 00 00 00 00 00 "
    "00 00 "
    "00 00 c8 00";

/// Whole requests.
inline constexpr std::string_view choose_fisheyes =
    "20 00 00 00 05 00 02 00 03 00 50 03 20 03 09 01 50 03 1e 00 23 00 50 03 20 03 09 01 50 03 1e 00";
inline constexpr std::string_view set_exposure =  // 5000 us, gain 4
    "20 00 00 00 17 00 02 00 03 00 00 00 88 13 00 00 00 00 80 40 23 00 00 00 88 13 00 00 00 00 80 40";

/// Whole messages of the streams.
inline constexpr std::string_view picture_right =  // number 77, 4321 us, gain 2.5
    "32 00 00 00 11 00 23 00 14 1a 99 be 1c 00 00 00 ef 1d 99 be 1c 00 00 00 4d 00 00 00 08 00 00 00 e1 10 "
    "00 00 "
    "00 00 20 40 06 00 00 00 01 02 03 04 05 06";
inline constexpr std::string_view acceleration =
    "34 00 00 00 11 00 04 00 01 00 00 00 00 00 00 00 02 00 00 00 00 00 00 00 03 00 00 00 04 00 00 00 00 00 "
    "f0 41 "
    "0c 00 00 00 00 00 00 00 00 00 00 00 cd cc 1c 41";
inline constexpr std::string_view stopped = "08 00 00 00 14 00 0c 00";

inline std::vector<std::uint8_t> bytes(std::string_view hex) {
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 3) {
    out.push_back(static_cast<std::uint8_t>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return out;
}

}  // namespace ca2::t265::golden
