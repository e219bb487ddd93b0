#include "drivers/camera/picture_folder.h"

#include <fstream>
#include <string>

#include "core/io/files.h"

namespace ca2 {

Result<void> save_picture(const std::filesystem::path& folder, std::int64_t time, const Image& image) {
  const Result<std::string> png = encode_png(image);
  if (!png) return fail(png.error());
  const std::string name = std::to_string(time) + ".png";
  const std::filesystem::path hidden = folder / ("." + name);
  std::ofstream stream(hidden, std::ios::binary);
  stream.write(png->data(), static_cast<std::streamsize>(png->size()));
  stream.close();
  std::error_code code;
  if (stream) std::filesystem::rename(hidden, folder / name, code);
  if (stream && !code) return {};
  std::error_code ignored;
  std::filesystem::remove(hidden, ignored);
  return fail(ErrorCode::io, (folder / name).string(),
              "cannot be written" + (code ? ": " + code.message() : ""), "is there room on the disk?");
}

}  // namespace ca2
