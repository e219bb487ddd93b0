/// @file Rows of interleaved colours: luminance of RGB, the Y of packed YUV, and YUV to RGB (BT.601).
#pragma once

#include <cstddef>
#include <cstdint>

namespace ca2 {

/// `pixels` triples; `blue_first`: BGR rather than RGB.
void rgb_to_grey(const std::uint8_t* from, std::size_t pixels, bool blue_first, std::uint8_t* to);
void swap_red_and_blue(const std::uint8_t* from, std::size_t pixels, std::uint8_t* to);

/// Every second byte, beginning with the first.
void take_every_second(const std::uint8_t* from, std::size_t count, std::uint8_t* to);

/// One pixel. `full_range`: 0 to 255 rather than 16 to 235 (luma) and 240 (chroma).
void yuv_to_rgb(int y, int u, int v, bool full_range, std::uint8_t* rgb);

}  // namespace ca2
