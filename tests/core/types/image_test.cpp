/// Grey levels of deep pictures: 0 to 255 from black to what is white in them.
#include "core/types/image.h"

#include <gtest/gtest.h>

#include <cstring>

namespace ca2 {
namespace {

Image deep(const std::vector<std::uint16_t>& values) {
  Image image{static_cast<int>(values.size()), 1, 1, 16, std::vector<std::uint8_t>(2 * values.size())};
  std::memcpy(image.bytes.data(), values.data(), image.bytes.size());
  return image;
}

TEST(Image, SixteenBitsAreScaledByTheirDepth) {
  EXPECT_EQ(to_grey8(deep({0, 257, 65535})).bytes, (std::vector<std::uint8_t>{0, 1, 255}));
  EXPECT_EQ(to_grey(deep({0, 51400, 65535})).pixels, (std::vector<float>{0, 200, 255}));
}

TEST(Image, TwelveAndTenBitsAtTheLowEndToo) {
  EXPECT_EQ(to_grey8(deep({0, 819, 4095})).bytes, (std::vector<std::uint8_t>{0, 51, 255}));
  EXPECT_EQ(to_grey8(deep({0, 819, 1700})).bytes, (std::vector<std::uint8_t>{0, 51, 106}));
  EXPECT_EQ(to_grey8(deep({0, 1023})).bytes, (std::vector<std::uint8_t>{0, 255}));
  EXPECT_EQ(to_grey8(deep({0, 4096})).bytes, (std::vector<std::uint8_t>{0, 16}));
}

TEST(Image, EightBitsAreTakenAsTheyAre) {
  EXPECT_EQ(to_grey8({2, 1, 1, 8, {3, 200}}).bytes, (std::vector<std::uint8_t>{3, 200}));
  EXPECT_EQ(to_grey({1, 1, 3, 8, {100, 100, 100}}).pixels.size(), 1u);
  EXPECT_TRUE(to_grey8({0, 0, 1, 16, {}}).empty());
}

}  // namespace
}  // namespace ca2
