/// @file Which files of a folder were taken together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/session/rig.h"
#include "core/types/result.h"

namespace ca2 {

/// Files of one view, by sensor.
using ImportGroup = std::map<std::string, std::filesystem::path>;

struct ImportPlan {
  std::vector<ImportGroup> groups;
  bool timed = false;      ///< paired by time stamps in the names
  std::size_t single = 0;  ///< files without a partner
};

/// Pictures and clouds of the rig's sensors under `folder`: in FOLDER/<sensor>, at any depth; where the rig
/// has one camera and one LiDAR, anywhere. Files belong together by the number at the end of their names;
/// numbers of 13 and more digits are times (ms, us or ns), and then the nearest within `tolerance` (s) belong
/// together.
Result<ImportPlan> plan_import(const std::filesystem::path& folder, const Rig& rig, double tolerance);

}  // namespace ca2
