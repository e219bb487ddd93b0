#include "core/io/jpeg.h"

#include <turbojpeg.h>

#include <memory>

namespace ca2 {
namespace {

constexpr int max_side = 30000;  // px, as read_png
constexpr std::size_t max_bytes = std::size_t{512} << 20;

}  // namespace

Result<std::string> encode_jpeg(const Image& image, int quality) {
  if (image.empty() || image.bits != 8) {
    return fail(ErrorCode::internal, "", "only 8-bit pictures can become JPEG");
  }
  const std::unique_ptr<void, int (*)(tjhandle)> compressor(tjInitCompress(), tjDestroy);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const bool grey = image.channels == 1;
  const int failed =
      tjCompress2(compressor.get(), image.bytes.data(), image.width, 0, image.height,
                  grey ? TJPF_GRAY : TJPF_RGB, &buffer, &size, grey ? TJSAMP_GRAY : TJSAMP_420, quality, 0);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owned(buffer, tjFree);
  if (failed)
    return fail(ErrorCode::io, "",
                std::string("JPEG compression failed: ") + tjGetErrorStr2(compressor.get()));
  return std::string(reinterpret_cast<const char*>(buffer), size);
}

Result<Image> decode_jpeg(std::string_view bytes, const std::string& name, JpegColours wanted) {
  const std::unique_ptr<void, int (*)(tjhandle)> decompressor(tjInitDecompress(), tjDestroy);
  const auto damaged = [&] {
    return fail(ErrorCode::data, name,
                std::string("not a whole JPEG: ") + tjGetErrorStr2(decompressor.get()));
  };
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  Image image;
  int subsampling = 0, colours = 0;
  if (tjDecompressHeader3(decompressor.get(), data, bytes.size(), &image.width, &image.height, &subsampling,
                          &colours) != 0) {
    return damaged();
  }
  image.channels = colours == TJCS_GRAY || wanted == JpegColours::grey ? 1 : 3;
  const std::size_t size = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                           image.bytes_per_pixel();
  if (image.width > max_side || image.height > max_side || size > max_bytes) {
    return fail(ErrorCode::data, name, "the picture is larger than 30000 x 30000 pixels or 512 MiB");
  }
  image.bytes.resize(size);
  if (tjDecompress2(decompressor.get(), data, bytes.size(), image.bytes.data(), image.width, 0, image.height,
                    image.channels == 1 ? TJPF_GRAY : TJPF_RGB, TJFLAG_STOPONWARNING) != 0) {
    return damaged();
  }
  return image;
}

}  // namespace ca2
