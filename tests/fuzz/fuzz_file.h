/// @file For readers that take a file's name only.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace ca2::fuzz {

/// A file in a directory of its own, which goes with it.
class File {
 public:
  explicit File(const std::string& name) {
    std::string directory = std::filesystem::temp_directory_path() / "ca2-fuzz-XXXXXX";
    path = std::filesystem::path(::mkdtemp(directory.data())) / name;
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    std::error_code ignored;
    std::filesystem::remove_all(path.parent_path(), ignored);
  }
  void write(std::string_view content) const {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
  }

  std::filesystem::path path;
};

}  // namespace ca2::fuzz
