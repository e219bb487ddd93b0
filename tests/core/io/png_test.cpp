#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <cstring>
#include <random>

#include "core/io/files.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

Image random_image(int width, int height, int channels, int bits, unsigned seed = 1) {
  Image image{width, height, channels, bits, {}};
  image.bytes.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                     image.bytes_per_pixel());
  std::mt19937_64 random(seed);
  for (auto& byte : image.bytes) byte = static_cast<std::uint8_t>(random());
  return image;
}

/// A PNG of any kind, written by libpng itself: `rows` are the packed samples of each row.
std::string foreign_png(int width, int height, int bits, int color_type, int interlace,
                        std::vector<std::vector<png_byte>> rows, const std::vector<png_color>& palette = {}) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, png_size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), size);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits, color_type,
               interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  std::vector<png_bytep> pointers;
  for (auto& row : rows) pointers.push_back(row.data());
  png_set_rows(png, info, pointers.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

TEST(Png, RoundTripsEveryFormat) {
  const test::TemporaryDirectory directory;
  for (const int channels : {1, 3}) {
    for (const int bits : {8, 16}) {
      for (const auto& [width, height] : {std::pair(1, 1), {7, 5}, {640, 3}}) {
        const Image image = random_image(width, height, channels, bits);
        ASSERT_TRUE(write_png(directory / "a.png", image));
        const auto read = read_png(directory / "a.png");
        ASSERT_TRUE(read) << read.error().text();
        EXPECT_EQ(read->width, width);
        EXPECT_EQ(read->height, height);
        EXPECT_EQ(read->channels, channels);
        EXPECT_EQ(read->bits, bits);
        EXPECT_EQ(read->bytes, image.bytes);
        const auto stored = encode_png(image, PngData::stored);
        ASSERT_TRUE(stored);
        EXPECT_GE(stored->size(), image.bytes.size());
        EXPECT_LE(stored->size(), image.bytes.size() + static_cast<std::size_t>(height) + 200);
        const auto decoded = decode_png(*stored, "stored");
        ASSERT_TRUE(decoded) << decoded.error().text();
        EXPECT_EQ(decoded->bytes, image.bytes);
      }
    }
  }
}

TEST(Png, ResolvesPaletteGreyBitsAlphaAndInterlace) {
  const std::vector<png_color> colours{{10, 20, 30}, {200, 100, 0}, {7, 8, 9}};
  const auto colour =
      decode_png(foreign_png(3, 1, 8, PNG_COLOR_TYPE_PALETTE, 0, {{2, 0, 1}}, colours), "p").value();
  EXPECT_EQ(colour.channels, 3);
  EXPECT_EQ(colour.bytes, (std::vector<std::uint8_t>{7, 8, 9, 10, 20, 30, 200, 100, 0}));

  const std::vector<png_color> greys{{10, 10, 10}, {200, 200, 200}};
  const auto grey =
      decode_png(foreign_png(3, 1, 8, PNG_COLOR_TYPE_PALETTE, 0, {{1, 0, 1}}, greys), "p").value();
  EXPECT_EQ(grey.channels, 1);
  EXPECT_EQ(grey.bytes, (std::vector<std::uint8_t>{200, 10, 200}));

  const auto bits = decode_png(foreign_png(4, 1, 1, PNG_COLOR_TYPE_GRAY, 0, {{0xA0}}), "p").value();
  EXPECT_EQ(bits.bytes, (std::vector<std::uint8_t>{255, 0, 255, 0}));

  const auto alpha =
      decode_png(foreign_png(2, 1, 8, PNG_COLOR_TYPE_RGB_ALPHA, 0, {{1, 2, 3, 0, 4, 5, 6, 128}}), "p")
          .value();
  EXPECT_EQ(alpha.channels, 3);
  EXPECT_EQ(alpha.bytes, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6}));

  const auto interlaced = decode_png(foreign_png(3, 3, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7,
                                                 {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}),
                                     "p")
                              .value();
  EXPECT_EQ(interlaced.bytes, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));

  const auto deep = decode_png(foreign_png(1, 1, 16, PNG_COLOR_TYPE_GRAY, 0, {{0x12, 0x34}}), "p").value();
  std::uint16_t sample = 0;
  std::memcpy(&sample, deep.bytes.data(), 2);
  EXPECT_EQ(sample, 0x1234);
}

TEST(Png, EveryTruncationIsAnError) {
  const std::string whole = encode_png(random_image(37, 11, 3, 8)).value();
  ASSERT_TRUE(decode_png(whole, "a.png"));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto cut = decode_png(whole.substr(0, size), "a.png");
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(cut.error().code, ErrorCode::data);
    EXPECT_EQ(cut.error().problems[0].where, "a.png");
  }
}

TEST(Png, EveryDamagedByteOfThePixelsIsAnError) {
  const std::string whole = encode_png(random_image(16, 16, 1, 8)).value();
  const std::size_t data = whole.find("IDAT"), end = whole.find("IEND");
  for (std::size_t i = data; i < end - 8; ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_FALSE(decode_png(damaged, "a.png")) << i;
  }
}

TEST(Png, HostileSizesAreRefusedBeforeMemoryIsTaken) {
  const std::string whole = encode_png(random_image(4, 4, 1, 8)).value();
  for (const std::uint32_t side : {20000u, 30001u, 0x7fffffffu}) {
    std::string hostile = whole;
    // Width and height at 16 and 20; the checksum of the 17 bytes from "IHDR" on at 29.
    const auto put = [&](std::size_t at, std::uint32_t value) {
      for (std::size_t i = 0; i < 4; ++i) hostile[at + i] = static_cast<char>(value >> (24 - 8 * i));
    };
    put(16, side);
    put(20, side);
    put(29, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(hostile.data() + 12), 17)));
    const auto read = decode_png(hostile, "bomb.png");
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, ErrorCode::data);
    EXPECT_EQ(read.error().text().find("CRC"), std::string::npos) << read.error().text();
  }
}

TEST(Png, OtherFilesAreNamed) {
  EXPECT_NE(decode_png("hello, I am a text", "t.png").error().text().find("not a PNG"), std::string::npos);
  EXPECT_NE(decode_png("", "t.png").error().text().find("empty"), std::string::npos);
  EXPECT_EQ(read_png("/nonexistent.png").error().code, ErrorCode::io);
}

TEST(Png, RefusesToWriteWhatIsNoPicture) {
  EXPECT_FALSE(encode_png(Image{}));
  EXPECT_FALSE(encode_png(Image{2, 2, 1, 8, {1, 2, 3}}));
  EXPECT_FALSE(encode_png(Image{1, 1, 2, 8, {1, 2}}));
}

}  // namespace
}  // namespace ca2
