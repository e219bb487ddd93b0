/// @file A picture as a camera or a file gave it.
#pragma once

#include <cstdint>
#include <vector>

namespace ca2 {

/// Pixels in rows from the top, without padding. The centre of the top-left pixel is (0, 0).
struct Image {
  int width = 0;
  int height = 0;
  int channels = 1;                 ///< 1 grey, 3 red-green-blue
  int bits = 8;                     ///< per channel: 8 or 16 (host byte order)
  std::vector<std::uint8_t> bytes;  ///< width * height * channels * bits / 8

  bool empty() const { return bytes.empty(); }
  std::size_t bytes_per_pixel() const { return static_cast<std::size_t>(channels * bits / 8); }
};

/// A grey picture in floating point, 0 (black) to 255 (white) whatever the source's depth: what corner
/// refinement works on, so that 16-bit pictures lose nothing.
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<float> pixels;

  float at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// Luminance (ITU-R BT.601 weights for colour) of an image; an empty image gives an empty one.
GreyImage to_grey(const Image& image);

/// The same at 8 bits, rounded: what detectors search.
Image to_grey8(const Image& image);

}  // namespace ca2
