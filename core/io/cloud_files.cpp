#include "core/io/cloud_files.h"

#include <algorithm>
#include <cctype>

#include "core/io/files.h"

namespace ca2 {
namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 30;

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

bool is_cloud_name(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".pcd" || ending == ".ply" || ending == ".csv" || ending == ".txt" || ending == ".xyz" ||
         ending == ".npy";
}

Result<Scan> read_cloud_file(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (ending == ".pcd") return read_pcd(file);
  const Result<std::string> content = read_text(file, most_bytes);
  if (!content) return fail(content.error());
  if (ending == ".ply") return parse_ply(*content, file.string());
  if (ending == ".npy") return parse_npy(*content, file.string());
  return parse_cloud_csv(*content, file.string());
}

}  // namespace ca2
