/// Grey levels of deep pictures: 0 to 255 from black to what is white in them.
#include "core/types/image.h"

#include <gtest/gtest.h>

#include <cmath>
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
  const Image image = deep({0, 51400, 65535});
  const GreyView view(image);
  EXPECT_EQ(view.at(0, 0), 0);
  EXPECT_EQ(view.at(1, 0), 200);
  EXPECT_EQ(view.at(2, 0), 255);
}

TEST(Image, SixteenBitsAreRoundedToTheNearest) {
  for (const int white : {1023, 4095, 65535}) {
    std::vector<std::uint16_t> values;
    for (int i = 0; i <= white; ++i) values.push_back(static_cast<std::uint16_t>(i));
    const Image grey8 = to_grey8(deep(values));
    for (int i = 0; i <= white; ++i) {
      ASSERT_EQ(grey8.bytes[static_cast<std::size_t>(i)], std::lround(255.0 * i / white))
          << i << " of " << white;
    }
  }
}

TEST(Image, ColourIsItsLuminance) {
  const Image image{2, 1, 3, 8, {100, 100, 100, 10, 200, 30}};
  EXPECT_NEAR(GreyView(image).at(0, 0), 100, 1e-4);
  EXPECT_NEAR(GreyView(image).at(1, 0), 0.299 * 10 + 0.587 * 200 + 0.114 * 30, 1e-4);
  EXPECT_EQ(to_grey8(image).bytes, (std::vector<std::uint8_t>{100, 124}));
}

TEST(Image, TwelveAndTenBitsAtTheLowEndToo) {
  EXPECT_EQ(to_grey8(deep({0, 819, 4095})).bytes, (std::vector<std::uint8_t>{0, 51, 255}));
  EXPECT_EQ(to_grey8(deep({0, 819, 1700})).bytes, (std::vector<std::uint8_t>{0, 51, 106}));
  EXPECT_EQ(to_grey8(deep({0, 1023})).bytes, (std::vector<std::uint8_t>{0, 255}));
  EXPECT_EQ(to_grey8(deep({0, 4096})).bytes, (std::vector<std::uint8_t>{0, 16}));
}

TEST(Image, EightBitsAreTakenAsTheyAre) {
  EXPECT_EQ(to_grey8({2, 1, 1, 8, {3, 200}}).bytes, (std::vector<std::uint8_t>{3, 200}));
  Image converted;
  const Image image{2, 1, 1, 8, {3, 200}};
  EXPECT_EQ(&as_grey8(image, converted), &image);
  EXPECT_TRUE(to_grey8({0, 0, 1, 16, {}}).empty());
}

}  // namespace
}  // namespace ca2
