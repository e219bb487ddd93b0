#include <cstring>

#include "core/io/jpeg.h"
#include "core/types/text.h"
#include "drivers/camera/pixel_formats/bayer.h"
#include "drivers/camera/pixel_formats/colours.h"
#include "drivers/camera/pixel_formats/pixel_format.h"
#include "drivers/camera/pixel_formats/samples.h"

namespace ca2 {
namespace {

constexpr int max_side = 30000;  // px, as read_png

/// What is in it will be overwritten.
Image blank(const RawPicture& raw, int channels, int bits) {
  Image image{raw.width, raw.height, channels, bits, {}};
  if (raw.memory) image.bytes = std::move(*raw.memory);
  image.bytes.resize(static_cast<std::size_t>(raw.width) * static_cast<std::size_t>(raw.height) *
                     image.bytes_per_pixel());
  return image;
}

std::uint16_t* words(Image& image) {
  return reinterpret_cast<std::uint16_t*>(image.bytes.data());
}

/// Bytes of a row of `bytes` and `words` formats; of NV12 a row of either plane.
std::size_t row_bytes(const RawPicture& raw) {
  const auto width = static_cast<std::size_t>(raw.width);
  if (raw.format->packing == PixelPacking::words) return 2 * width;
  switch (raw.format->colour) {
    case PixelColour::rgb:
    case PixelColour::bgr:
      return 3 * width;
    case PixelColour::yuyv:
    case PixelColour::uyvy:
      return 2 * width;
    case PixelColour::nv12:
      return 2 * ((width + 1) / 2);
    default:
      return width;
  }
}

bool packed(const PixelFormat& format) {
  return format.packing != PixelPacking::bytes && format.packing != PixelPacking::words;
}

std::size_t rows_of(const RawPicture& raw) {
  const auto height = static_cast<std::size_t>(raw.height);
  return raw.format->colour == PixelColour::nv12 ? height + (height + 1) / 2 : height;
}

Result<void> check(const RawPicture& raw) {
  const PixelFormat& format = *raw.format;
  const auto wrong = [&](const std::string& what) {
    return fail(
        ErrorCode::data, "",
        formatted("a %s picture of %d x %d ", std::string(format.name).c_str(), raw.width, raw.height) +
            what);
  };
  const int least = format.bayer() ? 2 : 1;
  if (raw.width < least || raw.height < least || raw.width > max_side || raw.height > max_side) {
    return wrong("is of no size that a camera has");
  }
  const bool pairs = format.colour == PixelColour::yuyv || format.colour == PixelColour::uyvy;
  if (pairs && raw.width % 2) return wrong("must have an even width");
  if (raw.bits < 0 || raw.bits > 16)
    return wrong("cannot have samples of " + std::to_string(raw.bits) + " bits");
  if (format.packing == PixelPacking::jpeg) return {};
  std::size_t need = format.tight_size(raw.width, raw.height);
  if (packed(format)) {
    if (raw.stride != 0) return wrong("is a stream of bits: it has no row length");
  } else {
    if (raw.stride != 0 && raw.stride < row_bytes(raw)) return wrong("cannot have such short rows");
    if (raw.stride != 0) need = raw.stride * (rows_of(raw) - 1) + row_bytes(raw);
  }
  if (raw.data.size() < need) {
    return wrong(formatted("has %zu bytes, %zu are needed", raw.data.size(), need));
  }
  return {};
}

/// The rows of a `bytes` format.
template <class Row>
void for_each_row(const RawPicture& raw, Row row) {
  const std::size_t stride = raw.stride ? raw.stride : row_bytes(raw);
  const std::uint8_t* line = raw.data.data();
  for (int y = 0; y < raw.height; ++y, line += stride) row(line, y);
}

/// Rows without padding of what is in memory as it is in an Image.
Image copied(const RawPicture& raw, int channels) {
  const std::size_t row = row_bytes(raw);
  Image image = blank(raw, channels, 8);
  if (raw.stride == 0 || raw.stride == row) {
    std::memcpy(image.bytes.data(), raw.data.data(), image.bytes.size());
    return image;
  }
  for_each_row(raw, [&](const std::uint8_t* line, int y) {
    std::memcpy(image.bytes.data() + row * static_cast<std::size_t>(y), line, row);
  });
  return image;
}

/// Mono or Bayer samples of more than 8 bits.
Image wide_samples(const RawPicture& raw) {
  Image image = blank(raw, 1, 16);
  const auto width = static_cast<std::size_t>(raw.width);
  const int bits = raw.bits ? raw.bits : raw.format->bits;
  if (packed(*raw.format)) {
    unpack_samples(raw.format->packing, raw.data.data(), width * static_cast<std::size_t>(raw.height),
                   words(image));
  } else {
    for_each_row(raw, [&](const std::uint8_t* line, int y) {
      widen_words(line, width, bits, words(image) + width * static_cast<std::size_t>(y));
    });
  }
  return image;
}

template <class Sample>
void demosaic(const RawPicture& raw, const Sample* from, std::size_t stride, PictureKind kind, Sample* to) {
  if (kind == PictureKind::grey) {
    bayer_to_grey(from, stride, raw.width, raw.height, raw.format->colour, to);
  } else {
    bayer_to_rgb(from, stride, raw.width, raw.height, raw.format->colour, to);
  }
}

Image bayer_image(const RawPicture& raw, PictureKind kind) {
  const int channels = kind == PictureKind::grey ? 1 : 3;
  if (raw.format->bits == 8) {
    Image image = blank(raw, channels, 8);
    const std::size_t stride = raw.stride ? raw.stride : static_cast<std::size_t>(raw.width);
    demosaic(raw, raw.data.data(), stride, kind, image.bytes.data());
    return image;
  }
  Image image = blank(raw, channels, 16);
  Image mosaic = wide_samples(raw);
  demosaic<std::uint16_t>(raw, words(mosaic), static_cast<std::size_t>(raw.width), kind, words(image));
  return image;
}

Image rgb_image(const RawPicture& raw, PictureKind kind) {
  const bool blue_first = raw.format->colour == PixelColour::bgr;
  if (kind == PictureKind::colour && !blue_first) return copied(raw, 3);
  Image image = blank(raw, kind == PictureKind::grey ? 1 : 3, 8);
  const auto width = static_cast<std::size_t>(raw.width);
  const std::size_t row = width * image.bytes_per_pixel();
  for_each_row(raw, [&](const std::uint8_t* line, int y) {
    std::uint8_t* to = image.bytes.data() + row * static_cast<std::size_t>(y);
    if (kind == PictureKind::grey) {
      rgb_to_grey(line, width, blue_first, to);
    } else {
      swap_red_and_blue(line, width, to);
    }
  });
  return image;
}

/// YUYV and UYVY: pairs of pixels share their chroma.
Image packed_yuv_image(const RawPicture& raw, PictureKind kind) {
  const bool luma_first = raw.format->colour == PixelColour::yuyv;
  const auto width = static_cast<std::size_t>(raw.width);
  Image image = blank(raw, kind == PictureKind::grey ? 1 : 3, 8);
  const std::size_t row = width * image.bytes_per_pixel();
  for_each_row(raw, [&](const std::uint8_t* line, int y) {
    std::uint8_t* to = image.bytes.data() + row * static_cast<std::size_t>(y);
    if (kind == PictureKind::grey) return take_every_second(line + (luma_first ? 0 : 1), width, to);
    for (std::size_t x = 0; x < width; ++x, to += 3) {
      const std::uint8_t* pair = line + 4 * (x / 2);
      const std::uint8_t* chroma = pair + (luma_first ? 1 : 0);
      yuv_to_rgb(pair[2 * (x % 2) + (luma_first ? 0 : 1)], chroma[0], chroma[2], raw.full_range, to);
    }
  });
  return image;
}

/// A plane of luma, then one of chroma pairs at half the size both ways.
Image nv12_image(const RawPicture& raw, PictureKind kind) {
  const auto width = static_cast<std::size_t>(raw.width), height = static_cast<std::size_t>(raw.height);
  // Without padding the rows of luma are as wide as the picture, those of chroma even.
  const std::size_t luma_stride = raw.stride ? raw.stride : width;
  const std::size_t chroma_stride = raw.stride ? raw.stride : 2 * ((width + 1) / 2);
  const std::uint8_t* chroma = raw.data.data() + luma_stride * height;
  Image image = blank(raw, kind == PictureKind::grey ? 1 : 3, 8);
  std::uint8_t* to = image.bytes.data();
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* luma = raw.data.data() + luma_stride * y;
    if (kind == PictureKind::grey) {
      std::memcpy(to, luma, width);
      to += width;
      continue;
    }
    const std::uint8_t* pairs = chroma + chroma_stride * (y / 2);
    for (std::size_t x = 0; x < width; ++x, to += 3) {
      yuv_to_rgb(luma[x], pairs[x / 2 * 2], pairs[x / 2 * 2 + 1], raw.full_range, to);
    }
  }
  return image;
}

Result<Image> jpeg_image(const RawPicture& raw, PictureKind kind) {
  const std::string_view bytes(reinterpret_cast<const char*>(raw.data.data()), raw.data.size());
  auto image = decode_jpeg(bytes, "", kind == PictureKind::grey ? JpegColours::grey : JpegColours::as_stored);
  if (image && (image->width != raw.width || image->height != raw.height)) {
    return fail(ErrorCode::data, "",
                formatted("a JPEG of %d x %d where %d x %d was agreed on", image->width, image->height,
                          raw.width, raw.height));
  }
  return image;
}

}  // namespace

Result<Image> to_image(const RawPicture& raw, PictureKind kind) {
  if (auto good = check(raw); !good) return fail(good.error());
  if (raw.format->packing == PixelPacking::jpeg) return jpeg_image(raw, kind);
  if (raw.format->bayer()) return bayer_image(raw, kind);
  switch (raw.format->colour) {
    case PixelColour::rgb:
    case PixelColour::bgr:
      return rgb_image(raw, kind);
    case PixelColour::yuyv:
    case PixelColour::uyvy:
      return packed_yuv_image(raw, kind);
    case PixelColour::nv12:
      return nv12_image(raw, kind);
    default:
      return raw.format->bits == 8 ? copied(raw, 1) : wide_samples(raw);
  }
}

}  // namespace ca2
