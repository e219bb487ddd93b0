#include "drivers/camera/pixel_formats/colours.h"

#include <algorithm>

#include "core/types/hot_loop.h"
#include "drivers/camera/pixel_formats/luminance.h"

namespace ca2 {

CA2_HOT_LOOP void rgb_to_grey(const std::uint8_t* from, std::size_t pixels, bool blue_first,
                              std::uint8_t* to) {
  const std::uint32_t first = blue_first ? blue_weight : red_weight;
  const std::uint32_t last = blue_first ? red_weight : blue_weight;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint32_t sum = first * from[3 * i] + green_weight * from[3 * i + 1] + last * from[3 * i + 2];
    to[i] = static_cast<std::uint8_t>((sum + (1u << (weight_bits - 1))) >> weight_bits);
  }
}

CA2_HOT_LOOP void swap_red_and_blue(const std::uint8_t* from, std::size_t pixels, std::uint8_t* to) {
  for (std::size_t i = 0; i < 3 * pixels; i += 3) {
    to[i] = from[i + 2];
    to[i + 1] = from[i + 1];
    to[i + 2] = from[i];
  }
}

CA2_HOT_LOOP void take_every_second(const std::uint8_t* from, std::size_t count, std::uint8_t* to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = from[2 * i];
}

void yuv_to_rgb(int y, int u, int v, bool full_range, std::uint8_t* rgb) {
  // BT.601: R = Y + 1.402 V', G = Y - 0.344136 U' - 0.714136 V', B = Y + 1.772 U'; U', V' around 128. Limited
  // range: luma times 255/219, chroma times 255/224. Shares of 2^16.
  constexpr int one = 1 << 16, half = one / 2;
  const int luma = full_range ? y * one : (y - 16) * 76309;
  const int du = u - 128, dv = v - 128;
  const int red = luma + dv * (full_range ? 91881 : 104597);
  const int green = luma - du * (full_range ? 22553 : 25675) - dv * (full_range ? 46802 : 53279);
  const int blue = luma + du * (full_range ? 116130 : 132201);
  rgb[0] = static_cast<std::uint8_t>(std::clamp((red + half) >> 16, 0, 255));
  rgb[1] = static_cast<std::uint8_t>(std::clamp((green + half) >> 16, 0, 255));
  rgb[2] = static_cast<std::uint8_t>(std::clamp((blue + half) >> 16, 0, 255));
}

}  // namespace ca2
