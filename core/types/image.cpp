#include "core/types/image.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ca2 {
namespace {

std::uint16_t sample16(const Image& image, std::size_t i) {
  std::uint16_t value = 0;
  std::memcpy(&value, image.bytes.data() + 2 * i, 2);
  return value;
}

/// What white is in a 16-bit picture: many programs leave the 10 or 12 bits of their cameras at the low end.
float white_of(const Image& image) {
  std::uint16_t most = 0;
  for (std::size_t i = 0; i < image.bytes.size() / 2; ++i) most = std::max(most, sample16(image, i));
  for (const int white : {1023, 4095}) {
    if (most <= white) return static_cast<float>(white);
  }
  return 65535;
}

/// Calls sink(index, grey 0..255) for every pixel.
template <class Sink>
void for_each_grey(const Image& image, Sink sink) {
  const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const float units = image.bits == 8 ? 1 : white_of(image) / 255;  // per grey level
  const auto sample = [&](std::size_t i) -> float {
    return image.bits == 8 ? static_cast<float>(image.bytes[i])
                           : static_cast<float>(sample16(image, i)) / units;
  };
  for (std::size_t i = 0; i < count; ++i) {
    sink(i, image.channels == 1
                ? sample(i)
                : 0.299f * sample(3 * i) + 0.587f * sample(3 * i + 1) + 0.114f * sample(3 * i + 2));
  }
}

}  // namespace

GreyImage to_grey(const Image& image) {
  if (image.empty()) return {};
  GreyImage grey{image.width, image.height, {}};
  grey.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for_each_grey(image, [&](std::size_t i, float value) { grey.pixels[i] = value; });
  return grey;
}

Image to_grey8(const Image& image) {
  if (image.channels == 1 && image.bits == 8) return image;
  Image grey{image.width, image.height, 1, 8, {}};
  if (image.empty()) return grey;
  grey.bytes.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for_each_grey(image, [&](std::size_t i, float value) {
    grey.bytes[i] = static_cast<std::uint8_t>(std::lround(value));
  });
  return grey;
}

}  // namespace ca2
