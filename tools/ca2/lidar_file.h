/// @file What a file that came with a LiDAR is: metadata, calibration.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

struct LidarFile {
  std::string kind;             ///< in words
  Result<std::string> summary;  ///< in words
  std::vector<Problem> warnings;
};

/// Nothing where it is no such file. `text`: its content.
std::optional<LidarFile> look_at_lidar_file(const std::filesystem::path& file, const std::string& text);

/// What Ouster metadata leave out or contradict themselves in.
std::vector<Problem> metadata_doubts(const std::filesystem::path& file);

}  // namespace ca2
