#include "drivers/lidar/text_file.h"

#include <fstream>

namespace ca2 {

Result<std::string> read_sensor_file(const std::filesystem::path& file) {
  constexpr std::size_t limit = 4u << 20;  // real ones have 50 kB
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail(ErrorCode::io, file.string(), "cannot be opened", "check the path");
  std::string text(limit + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) return fail(ErrorCode::io, file.string(), "cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > limit)
    return fail(ErrorCode::data, file.string(), "larger than 4 MiB: not a sensor's file");
  return text;
}

}  // namespace ca2
