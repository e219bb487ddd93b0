/// @file `ca2 record cameras`: pictures into a recording's folders, without the daemon.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

struct CameraRecordingOptions {
  std::vector<std::string> cameras;  ///< NAME=SOURCE
  std::filesystem::path output;      ///< the recording
  double duration = 0;               ///< s; 0: until Ctrl-C
  bool as_json = false;
};

Result<int> record_cameras(const CameraRecordingOptions& options);

}  // namespace ca2
