#include "core/io/files.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  for (const int channels : {1, 3}) {
    for (const int bits : {8, 16}) {
      ca2::Image image{5, 4, channels, bits, {}};
      for (std::size_t i = 0; i < 20 * image.bytes_per_pixel(); ++i) {
        image.bytes.push_back(static_cast<std::uint8_t>(37 * i));
      }
      all.push_back(encode_png(image).value());
    }
  }
  return all;
}

}  // namespace ca2::fuzz

/// Whatever is read is a whole picture, and writing it gives the same one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ca2::fuzz::require;
  const auto image = ca2::decode_png({reinterpret_cast<const char*>(data), size}, "input");
  if (!image) return 0;
  // Writing large ones costs seconds and finds nothing new.
  if (image->bytes.size() > 1u << 20) return 0;
  const auto bytes = ca2::encode_png(*image);
  require(bytes.has_value(), "a picture that does not fit together");
  const auto again = ca2::decode_png(*bytes, "again");
  require(again && again->bytes == image->bytes && again->width == image->width, "the picture changed");
  return 0;
}
