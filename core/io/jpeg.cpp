#include "core/io/jpeg.h"

#include <turbojpeg.h>

#include <memory>

namespace ca2 {

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

}  // namespace ca2
