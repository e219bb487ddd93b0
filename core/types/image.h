/// @file A picture as a camera or a file gave it.
#pragma once

#include <cstdint>
#include <cstring>
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

/// The pixels of a picture in grey, 0 (black) to 255 (white) whatever its depth, with ITU-R BT.601 weights
/// for colour: what corner refinement works on, so that 16-bit pictures lose nothing. Refers to the picture.
class GreyView {
 public:
  explicit GreyView(const Image& image);

  int width() const { return image_.width; }
  int height() const { return image_.height; }
  float at(int x, int y) const {
    const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + x;
    if (image_.channels == 1) return sample(i);
    return 0.299f * sample(3 * i) + 0.587f * sample(3 * i + 1) + 0.114f * sample(3 * i + 2);
  }

 private:
  float sample(std::size_t i) const {
    if (image_.bits == 8) return static_cast<float>(image_.bytes[i]);
    std::uint16_t value = 0;
    std::memcpy(&value, image_.bytes.data() + 2 * i, 2);
    return static_cast<float>(value) / units_;
  }

  const Image& image_;
  float units_;  ///< per grey level
};

/// The same at 8 bits, rounded: what detectors search. An empty image gives an empty one.
Image to_grey8(const Image& image);
/// The picture itself where it is so already; otherwise `converted`, which is made to be it.
const Image& as_grey8(const Image& image, Image& converted);

}  // namespace ca2
