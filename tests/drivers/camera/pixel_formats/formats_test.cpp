/// Every format of the table against a plain reading of its definition, bit by bit, and against OpenCV.
#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>

#include "core/io/jpeg.h"
#include "drivers/camera/pixel_formats/pixel_format.h"

namespace ca2 {
namespace {

/// Samples of a mono or Bayer picture, or interleaved ones of RGB.
struct Samples {
  int width = 0, height = 0;
  std::vector<int> values;
  int at(int x, int y) const { return values[static_cast<std::size_t>(y * width + x)]; }
};

Samples random_samples(int width, int height, int bits, unsigned seed) {
  std::mt19937 random(seed);
  Samples samples{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    samples.values.push_back(static_cast<int>(random() >> (32 - bits)));
  return samples;
}

/// The samples as the format's definition lays them out, one bit at a time.
std::vector<std::uint8_t> encoded(const Samples& samples, PixelPacking packing, int bits) {
  std::vector<std::uint8_t> bytes;
  const std::size_t count = samples.values.size();
  if (packing == PixelPacking::bytes) {
    for (const int value : samples.values) bytes.push_back(static_cast<std::uint8_t>(value));
  } else if (packing == PixelPacking::words) {
    for (const int value : samples.values) {
      bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
      bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    }
  } else if (packing == PixelPacking::pfnc10 || packing == PixelPacking::pfnc12) {
    bytes.resize((count * static_cast<std::size_t>(bits) + 7) / 8);
    for (std::size_t i = 0; i < count * static_cast<std::size_t>(bits); ++i) {
      const int value = samples.values[i / static_cast<std::size_t>(bits)];
      if ((value >> (i % static_cast<std::size_t>(bits))) & 1) {
        bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | 1 << (i % 8));
      }
    }
  } else {
    const int low = bits - 8;
    for (std::size_t i = 0; i < count; i += 2) {
      const int a = samples.values[i], b = i + 1 < count ? samples.values[i + 1] : 0;
      const int mask = (1 << low) - 1;
      bytes.push_back(static_cast<std::uint8_t>(a >> low));
      bytes.push_back(static_cast<std::uint8_t>((a & mask) | (b & mask) << 4));
      if (i + 1 < count) bytes.push_back(static_cast<std::uint8_t>(b >> low));
    }
  }
  return bytes;
}

int sample_of(const Image& image, int x, int y, int channel = 0) {
  const std::size_t i =
      (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)) *
          static_cast<std::size_t>(image.channels) +
      static_cast<std::size_t>(channel);
  if (image.bits == 8) return image.bytes[i];
  std::uint16_t value = 0;
  std::memcpy(&value, &image.bytes[2 * i], 2);
  return value;
}

/// 'R', 'G' or 'B' of a place of the mosaic.
char colour_at(PixelColour order, int x, int y) {
  const char* rows = order == PixelColour::bayer_gr   ? "GRBG"
                     : order == PixelColour::bayer_rg ? "RGGB"
                     : order == PixelColour::bayer_gb ? "GBRG"
                                                      : "BGGR";
  return rows[2 * (y & 1) + (x & 1)];
}

/// A colour at a place: the mean of the nearest samples of that colour, the mosaic mirrored at its rim.
double interpolated(const Samples& mosaic, PixelColour order, int x, int y, char colour) {
  if (colour_at(order, x, y) == colour) return mosaic.at(x, y);
  double sum = 0;
  int count = 0, nearest = 3;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (colour_at(order, x + dx, y + dy) != colour) continue;
      const int distance = std::abs(dx) + std::abs(dy);
      if (distance > nearest) continue;
      if (distance < nearest) sum = count = 0;
      nearest = distance;
      const auto mirrored = [](int i, int size) { return i < 0 ? -i : i >= size ? 2 * size - 2 - i : i; };
      sum += mosaic.at(mirrored(x + dx, mosaic.width), mirrored(y + dy, mosaic.height));
      ++count;
    }
  }
  return sum / count;
}

class EveryFormat : public testing::TestWithParam<PixelFormat> {};

std::string name_of(const testing::TestParamInfo<PixelFormat>& info) {
  return std::string(info.param.name);
}

template <class Match>
std::vector<PixelFormat> formats_that(Match match) {
  std::vector<PixelFormat> all;
  for (const PixelFormat& format : pixel_formats()) {
    if (match(format)) all.push_back(format);
  }
  return all;
}

/// One sample per pixel.
class EverySampleFormat : public EveryFormat {};
/// Bytes and words in rows that may be padded.
class EveryRowFormat : public EveryFormat {};

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, testing::ValuesIn(pixel_formats()), name_of);
INSTANTIATE_TEST_SUITE_P(Formats, EverySampleFormat, testing::ValuesIn(formats_that([](const PixelFormat& f) {
                           return f.colour == PixelColour::mono || f.bayer();
                         })),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Formats, EveryRowFormat, testing::ValuesIn(formats_that([](const PixelFormat& f) {
                           return f.packing == PixelPacking::bytes || f.packing == PixelPacking::words;
                         })),
                         name_of);

TEST_P(EveryFormat, IsFoundByItsNames) {
  const PixelFormat& format = GetParam();
  EXPECT_EQ(find_pixel_format(format.name)->name, format.name);
  if (format.pfnc) {
    EXPECT_EQ(pixel_format_of_pfnc(format.pfnc)->name, format.name);
    // GenICam's codes tell the bits that a pixel takes.
    EXPECT_EQ(format.tight_size(16, 4) * 8, (format.pfnc >> 16 & 0xff) * 64);
  }
  if (format.fourcc) {
    EXPECT_EQ(pixel_format_of_fourcc(format.fourcc)->name, format.name);
  }
  EXPECT_TRUE(format.pfnc || format.fourcc);
}

TEST_P(EverySampleFormat, GivesTheSamplesOfItsDefinition) {
  const PixelFormat& format = GetParam();
  for (const auto& [width, height] : {std::pair(2, 2), {3, 5}, {16, 8}, {37, 11}, {50, 3}, {641, 4}}) {
    const Samples samples = random_samples(width, height, format.bits, static_cast<unsigned>(width));
    const auto bytes = encoded(samples, format.packing, format.bits);
    ASSERT_EQ(bytes.size(), format.tight_size(width, height));
    const RawPicture raw{&format, width, height, 0, bytes};
    const auto grey = to_image(raw, PictureKind::grey);
    const auto colour = to_image(raw, PictureKind::colour);
    ASSERT_TRUE(grey) << grey.error().text();
    ASSERT_TRUE(colour) << colour.error().text();
    ASSERT_EQ(grey->bits, format.bits == 8 ? 8 : 16);
    ASSERT_EQ(grey->channels, 1);
    ASSERT_EQ(colour->channels, format.bayer() ? 3 : 1);
    const int scale = format.bits == 8 ? 1 : 1 << (16 - format.bits);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!format.bayer()) {
          ASSERT_EQ(sample_of(*grey, x, y), scale * samples.at(x, y)) << x << ", " << y;
          continue;
        }
        const double red = scale * interpolated(samples, format.colour, x, y, 'R');
        const double green = scale * interpolated(samples, format.colour, x, y, 'G');
        const double blue = scale * interpolated(samples, format.colour, x, y, 'B');
        ASSERT_NEAR(sample_of(*colour, x, y, 0), red, 0.5) << x << ", " << y;
        ASSERT_NEAR(sample_of(*colour, x, y, 1), green, 0.5) << x << ", " << y;
        ASSERT_NEAR(sample_of(*colour, x, y, 2), blue, 0.5) << x << ", " << y;
        // The weights are rounded to 2^-14: at 16 bits that is up to 4 levels.
        ASSERT_NEAR(sample_of(*grey, x, y), 0.299 * red + 0.587 * green + 0.114 * blue,
                    format.bits == 8 ? 0.52 : 4.5)
            << x << ", " << y;
      }
    }
  }
}

TEST_P(EveryFormat, RefusesWhatDoesNotFit) {
  const PixelFormat& format = GetParam();
  const std::vector<std::uint8_t> bytes(4096);
  const std::size_t need = format.tight_size(16, 8);
  if (format.packing == PixelPacking::jpeg) {
    EXPECT_FALSE(to_image({&format, 16, 8, 0, bytes}, PictureKind::grey));
    return;
  }
  const std::span<const std::uint8_t> all(bytes);
  EXPECT_TRUE(to_image({&format, 16, 8, 0, all.first(need)}, PictureKind::grey));
  const auto few = to_image({&format, 16, 8, 0, all.first(need - 1)}, PictureKind::grey);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, ErrorCode::data);
  for (const auto& [width, height] : {std::pair(0, 8), {16, 0}, {-16, 8}, {16, -8}, {1 << 20, 1 << 20}}) {
    EXPECT_FALSE(to_image({&format, width, height, 0, bytes}, PictureKind::grey));
  }
  EXPECT_FALSE(to_image({&format, 16, 8, 3, bytes}, PictureKind::grey));
}

/// Rows with padding (V4L2's bytesperline), and none after the last.
TEST_P(EveryRowFormat, PaddingIsSkipped) {
  const PixelFormat& format = GetParam();
  constexpr int width = 14, height = 6;
  const bool planes = format.colour == PixelColour::nv12;
  const std::size_t line = planes ? width : format.tight_size(width, height) / height;
  const std::size_t lines = planes ? height * 3 / 2 : height;
  std::mt19937 random(3);
  std::vector<std::uint8_t> tight(line * lines), padded((line + 6) * lines - 6, 0xee);
  ASSERT_EQ(tight.size(), format.tight_size(width, height));
  for (auto& byte : tight) byte = static_cast<std::uint8_t>(random());
  for (std::size_t y = 0; y < lines; ++y) std::memcpy(&padded[y * (line + 6)], &tight[y * line], line);
  for (const PictureKind kind : {PictureKind::grey, PictureKind::colour}) {
    const auto a = to_image({&format, width, height, 0, tight}, kind);
    const auto b = to_image({&format, width, height, line + 6, padded}, kind);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->bytes, b->bytes);
  }
}

TEST(PixelFormats, NamesAndCodesAreUnique) {
  std::set<std::string_view> names;
  std::set<std::uint32_t> pfnc, fourcc;
  for (const PixelFormat& format : pixel_formats()) {
    EXPECT_TRUE(names.insert(format.name).second);
    EXPECT_TRUE(format.pfnc == 0 || pfnc.insert(format.pfnc).second) << format.name;
    EXPECT_TRUE(format.fourcc == 0 || fourcc.insert(format.fourcc).second) << format.name;
  }
  EXPECT_EQ(fourcc_text(find_pixel_format("YUV422_8")->fourcc), "YUYV");
}

cv::Mat view(const Image& image) {
  return {image.height, image.width, CV_MAKETYPE(image.bits == 8 ? CV_8U : CV_16U, image.channels),
          const_cast<std::uint8_t*>(image.bytes.data())};
}

double most_difference(const cv::Mat& a, const cv::Mat& b) {
  const cv::Rect inside(1, 1, a.cols - 2, a.rows - 2);  // OpenCV treats the rim of mosaics otherwise
  return cv::norm(a(inside), b(inside), cv::NORM_INF);
}

TEST(PixelFormats, AgreeWithOpenCv) {
  constexpr int width = 64, height = 48;
  std::mt19937 random(5);
  std::vector<std::uint8_t> bytes(2 * 3 * width * height);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  // OpenCV names mosaics by the second row's second and third sample.
  for (const auto& [name, to_rgb, to_grey] :
       {std::tuple("BayerRG", cv::COLOR_BayerBG2RGB, cv::COLOR_BayerBG2GRAY),
        {"BayerBG", cv::COLOR_BayerRG2RGB, cv::COLOR_BayerRG2GRAY},
        {"BayerGR", cv::COLOR_BayerGB2RGB, cv::COLOR_BayerGB2GRAY},
        {"BayerGB", cv::COLOR_BayerGR2RGB, cv::COLOR_BayerGR2GRAY}}) {
    for (const int bits : {8, 16}) {
      const RawPicture raw{find_pixel_format(name + std::to_string(bits)), width, height, 0, bytes};
      const cv::Mat mosaic(height, width, bits == 8 ? CV_8U : CV_16U, bytes.data());
      cv::Mat rgb, grey;
      cv::cvtColor(mosaic, rgb, to_rgb);
      cv::cvtColor(mosaic, grey, to_grey);
      EXPECT_LE(most_difference(view(to_image(raw, PictureKind::colour).value()), rgb), 1) << name << bits;
      EXPECT_LE(most_difference(view(to_image(raw, PictureKind::grey).value()), grey), bits == 8 ? 1 : 4)
          << name << bits;
    }
  }
  // Luma below black is cut off by OpenCV first, so that it loses chroma.
  for (auto& byte : bytes) byte = std::max<std::uint8_t>(byte, 16);
  const auto agrees = [&](const char* name, int type, int rows, int code, PictureKind kind,
                          double tolerance) {
    const RawPicture raw{find_pixel_format(name), width, height, 0, bytes};
    cv::Mat expected;
    cv::cvtColor(cv::Mat(rows, width, type, bytes.data()), expected, code);
    EXPECT_LE(most_difference(view(to_image(raw, kind).value()), expected), tolerance) << name;
  };
  agrees("RGB8", CV_8UC3, height, cv::COLOR_RGB2GRAY, PictureKind::grey, 1);
  agrees("BGR8", CV_8UC3, height, cv::COLOR_BGR2GRAY, PictureKind::grey, 1);
  agrees("BGR8", CV_8UC3, height, cv::COLOR_BGR2RGB, PictureKind::colour, 0);
  agrees("YUV422_8", CV_8UC2, height, cv::COLOR_YUV2GRAY_YUYV, PictureKind::grey, 0);
  agrees("YUV422_8", CV_8UC2, height, cv::COLOR_YUV2RGB_YUYV, PictureKind::colour, 1);
  agrees("YUV422_8_UYVY", CV_8UC2, height, cv::COLOR_YUV2GRAY_UYVY, PictureKind::grey, 0);
  agrees("YUV422_8_UYVY", CV_8UC2, height, cv::COLOR_YUV2RGB_UYVY, PictureKind::colour, 1);
  agrees("NV12", CV_8U, height * 3 / 2, cv::COLOR_YUV2GRAY_NV12, PictureKind::grey, 0);
  agrees("NV12", CV_8U, height * 3 / 2, cv::COLOR_YUV2RGB_NV12, PictureKind::colour, 1);
}

/// Full range: black, white and grey are what they are.
TEST(PixelFormats, RangeOfYuv) {
  const PixelFormat* format = find_pixel_format("YUV422_8");
  const std::vector<std::uint8_t> full{0, 128, 255, 128}, limited{16, 128, 235, 128};
  RawPicture raw{format, 2, 1, 0, full, 0, true};
  EXPECT_EQ(to_image(raw, PictureKind::colour)->bytes, (std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255}));
  raw.data = limited;
  raw.full_range = false;
  EXPECT_EQ(to_image(raw, PictureKind::colour)->bytes, (std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255}));
}

/// A UVC camera that sends 10 bits as Y16.
TEST(PixelFormats, FewerBitsThanTheFormatHas) {
  const std::vector<std::uint8_t> bytes{0xff, 0x03, 0x00, 0x02};
  RawPicture raw{find_pixel_format("Mono16"), 2, 1, 0, bytes};
  raw.bits = 10;
  const auto image = to_image(raw, PictureKind::grey);
  EXPECT_EQ(sample_of(*image, 0, 0), 0x3ff << 6);
  EXPECT_EQ(sample_of(*image, 1, 0), 0x200 << 6);
}

Image colourful(int width, int height) {
  Image image{width, height, 3, 8, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const int value : {x * 255 / width, y * 255 / height, 128}) {
        image.bytes.push_back(static_cast<std::uint8_t>(value));
      }
    }
  }
  return image;
}

/// The JPEG without its tables, as many UVC cameras send it.
std::string without_huffman_tables(std::string jpeg) {
  std::size_t i = 2;
  while (i + 4 < jpeg.size()) {
    const auto marker = static_cast<unsigned char>(jpeg[i + 1]);
    const std::size_t length =
        2 + (static_cast<unsigned char>(jpeg[i + 2]) << 8 | static_cast<unsigned char>(jpeg[i + 3]));
    if (marker == 0xda) break;
    if (marker == 0xc4) {
      jpeg.erase(i, length);
    } else {
      i += length;
    }
  }
  return jpeg;
}

TEST(PixelFormats, MotionJpegWithAndWithoutTables) {
  const Image picture = colourful(160, 96);
  const std::string jpeg = encode_jpeg(picture, 95).value();
  const std::string bare = without_huffman_tables(jpeg);
  ASSERT_LT(bare.size(), jpeg.size());
  const PixelFormat* format = find_pixel_format("MJPG");
  const auto decoded = [&](const std::string& bytes, PictureKind kind) {
    return to_image({format, 160, 96, 0, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}},
                    kind);
  };
  const auto full = decoded(jpeg, PictureKind::colour);
  ASSERT_TRUE(full) << full.error().text();
  EXPECT_LT(cv::norm(view(*full), view(picture), cv::NORM_L1) / static_cast<double>(picture.bytes.size()), 2);
  ASSERT_TRUE(decoded(bare, PictureKind::colour));
  EXPECT_EQ(decoded(bare, PictureKind::colour)->bytes, full->bytes);
  // Cameras pad to the size of a USB packet.
  EXPECT_EQ(decoded(jpeg + std::string(700, '\0'), PictureKind::colour)->bytes, full->bytes);
  const auto grey = decoded(bare, PictureKind::grey);
  ASSERT_TRUE(grey);
  cv::Mat expected;
  cv::cvtColor(view(*full), expected, cv::COLOR_RGB2GRAY);
  EXPECT_LE(cv::norm(view(*grey), expected, cv::NORM_INF), 2);
}

TEST(PixelFormats, DamagedMotionJpegIsNotUsed) {
  const std::string jpeg = encode_jpeg(colourful(160, 96), 95).value();
  const PixelFormat* format = find_pixel_format("MJPG");
  const auto refused = [&](const std::string& bytes, int width = 160) {
    const auto image =
        to_image({format, width, 96, 0, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}},
                 PictureKind::grey);
    return !image && image.error().code == ErrorCode::data;
  };
  EXPECT_FALSE(refused(jpeg));
  EXPECT_TRUE(refused(jpeg, 320));
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused("no jpeg at all"));
  for (const double share : {0.1, 0.5, 0.9}) {
    EXPECT_TRUE(refused(jpeg.substr(0, static_cast<std::size_t>(share * static_cast<double>(jpeg.size())))))
        << share;
  }
}

}  // namespace
}  // namespace ca2
