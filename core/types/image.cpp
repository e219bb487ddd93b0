#include "core/types/image.h"

#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

CA2_HOT_LOOP std::uint16_t most_of(const std::uint8_t* __restrict from, std::size_t size) {
  std::uint16_t most = 0;
  for (std::size_t i = 0; i < size; ++i) {
    std::uint16_t value = 0;
    std::memcpy(&value, from + 2 * i, 2);
    most = value > most ? value : most;
  }
  return most;
}

/// What white is in a 16-bit picture: many programs leave the 10 or 12 bits of their cameras at the low end.
float white_of(const Image& image) {
  const std::uint16_t most = most_of(image.bytes.data(), image.bytes.size() / 2);
  for (const int white : {1023, 4095}) {
    if (most <= white) return static_cast<float>(white);
  }
  return 65535;
}

float units_of(const Image& image) {
  return image.bits == 8 ? 1 : white_of(image) / 255;
}

/// Rounded: none of the quotients is half-way.
CA2_HOT_LOOP void scale(std::size_t size, float units, const std::uint8_t* __restrict from,
                        std::uint8_t* __restrict to) {
  for (std::size_t i = 0; i < size; ++i) {
    std::uint16_t value = 0;
    std::memcpy(&value, from + 2 * i, 2);
    to[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(static_cast<float>(value) / units + 0.5f));
  }
}

}  // namespace

GreyView::GreyView(const Image& image) : image_(image), units_(units_of(image)) {}

Image to_grey8(const Image& image) {
  if (image.channels == 1 && image.bits == 8) return image;
  Image grey{image.width, image.height, 1, 8, {}};
  if (image.empty()) return grey;
  grey.bytes.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  if (image.channels == 1) {
    scale(grey.bytes.size(), units_of(image), image.bytes.data(), grey.bytes.data());
    return grey;
  }
  const GreyView view(image);
  std::uint8_t* to = grey.bytes.data();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) *to++ = static_cast<std::uint8_t>(view.at(x, y) + 0.5f);
  }
  return grey;
}

const Image& as_grey8(const Image& image, Image& converted) {
  if (image.channels == 1 && image.bits == 8) return image;
  return converted = to_grey8(image);
}

}  // namespace ca2
