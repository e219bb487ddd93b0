/// @file What the fake T265 and the tests that watch it agree on.
#pragma once

#include <cstdint>
#include <vector>

namespace ca2::test {

inline constexpr int t265_width = 848, t265_height = 800;  // px
inline constexpr char t265_serial[] = "908412110993";

/// A pixel that no other row, column, imager or picture number nearby has in the same place. The first eight
/// pixels of a picture are not this but the host's UTC in ns at the middle of its exposure, little-endian.
inline std::uint8_t t265_pixel(int imager, std::uint32_t number, int x, int y) {
  const auto at = static_cast<std::uint32_t>(x * 7 + y * 13 + (x * y >> 3));
  return static_cast<std::uint8_t>(at + number * 31 + static_cast<std::uint32_t>(imager) * 101);
}

/// Of the factory's calibration, by imager; the left's are a real unit's.
struct FakeFisheye {
  float cx, cy, fx, fy;  ///< px
  float k[4];
  float R[9];  ///< column by column, sensor to pose frame
  float t[3];  ///< m
};
inline constexpr FakeFisheye t265_fisheyes[2] = {
    {419.467f,
     386.975f,
     286.222f,
     287.480f,
     {-0.004348f, 0.037126f, -0.035539f, 0.005773f},
     {1, 0, 0, 0, -1, 0, 0, 0, -1},
     {-0.032f, 0, 0}},
    // Turned by 10 mrad about its y axis.
    {422.039f,
     397.016f,
     285.229f,
     286.334f,
     {-0.005279f, 0.038634f, -0.036636f, 0.006108f},
     {0.99995f, 0, 0.00999983f, 0, -1, 0, 0.00999983f, 0, -0.99995f},
     {0.032f, 0.0005f, 0}}};

}  // namespace ca2::test
