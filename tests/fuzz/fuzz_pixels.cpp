#include "core/io/jpeg.h"
#include "drivers/camera/pixel_formats/pixel_format.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

/// What a camera says of its picture, before the picture's bytes.
struct Header {
  std::uint8_t format, width, height, stride, bits, flags;
};

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  const auto formats = pixel_formats();
  Image image{24, 16, 3, 8, {}};
  for (int i = 0; i < 24 * 16 * 3; ++i) image.bytes.push_back(static_cast<std::uint8_t>(7 * i));
  for (std::size_t i = 0; i < formats.size(); ++i) {
    std::string seed{static_cast<char>(i), 24, 16, 0, 0, 0};
    if (formats[i].packing == PixelPacking::jpeg) {
      seed += encode_jpeg(image, 80).value();
    } else {
      seed += std::string(formats[i].tight_size(24, 16), '\x5a');
    }
    all.push_back(seed);
  }
  return all;
}

}  // namespace ca2::fuzz

/// Whatever a camera sends becomes a whole picture of the size agreed on, or an error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  if (size < sizeof(fuzz::Header)) return 0;
  const fuzz::Header header{data[0], data[1], data[2], data[3], data[4], data[5]};
  RawPicture raw;
  raw.format = &pixel_formats()[header.format % pixel_formats().size()];
  raw.width = header.width;
  raw.height = header.height;
  raw.stride = header.stride;
  raw.bits = header.bits;
  raw.full_range = header.flags & 1;
  // A copy that ends where the data ends, so that a byte read beyond it is found.
  const std::vector<std::uint8_t> bytes(data + sizeof(fuzz::Header), data + size);
  raw.data = bytes;
  for (const PictureKind kind : {PictureKind::grey, PictureKind::colour}) {
    const auto image = to_image(raw, kind);
    if (!image) {
      fuzz::require(image.error().code == ErrorCode::data, "the wrong kind of error");
      continue;
    }
    fuzz::require(image->width == raw.width && image->height == raw.height, "another size");
    fuzz::require(image->bytes.size() == static_cast<std::size_t>(image->width) *
                                             static_cast<std::size_t>(image->height) *
                                             image->bytes_per_pixel(),
                  "half a picture");
  }
  return 0;
}
