#include "core/io/read_picture.h"

#include <algorithm>
#include <cctype>

#include "core/io/files.h"
#include "core/io/jpeg.h"

namespace ca2 {

Result<Image> read_picture(const std::filesystem::path& file) {
  const Result<std::string> bytes = read_text(file, std::size_t{512} << 20);
  if (!bytes) return fail(bytes.error());
  if (bytes->starts_with("\xff\xd8")) return decode_jpeg(*bytes, file.string());
  return decode_png(*bytes, file.string());
}

bool is_picture_name(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

}  // namespace ca2
