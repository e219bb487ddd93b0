/// @file The weights of red, green and blue in luminance (ITU-R BT.601), as shares of 2^14.
#pragma once

#include <cstdint>

namespace ca2 {

inline constexpr std::uint32_t red_weight = 4899, green_weight = 9617, blue_weight = 1868;
inline constexpr int weight_bits = 14;
static_assert(red_weight + green_weight + blue_weight == 1u << weight_bits);

}  // namespace ca2
