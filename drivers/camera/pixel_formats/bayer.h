/// @file Mosaics of red, green and blue samples to luminance or colours, by linear interpolation.
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/camera/pixel_formats/pixel_format.h"

namespace ca2 {

/// Samples of 8 or 16 bits (`Sample` is std::uint8_t or std::uint16_t), `stride` samples from row to row, at
/// least 2 x 2. `to` has width * height samples, without padding; of to_rgb three times as many. A missing
/// colour is the mean of its two or four nearest samples; beyond the rim the mosaic is mirrored.
template <class Sample>
void bayer_to_grey(const Sample* from, std::size_t stride, int width, int height, PixelColour order,
                   Sample* to);
template <class Sample>
void bayer_to_rgb(const Sample* from, std::size_t stride, int width, int height, PixelColour order,
                  Sample* to);

}  // namespace ca2
