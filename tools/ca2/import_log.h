/// @file Pictures and clouds of an LCM log (docs/import.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/session/rig.h"
#include "core/types/image.h"
#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

/// A view of a log: for each sensor, where its message begins in the file, bytes.
using LogGroup = std::map<std::string, std::int64_t>;

struct LogPlan {
  std::vector<LogGroup> groups;
  std::size_t single = 0;  ///< messages of the slowest sensor without a partner
};

/// Reads the whole log once and puts messages together whose measurements are at most `tolerance` (s) apart.
/// A sensor's channel is `channels[sensor]`, or the one of its name (letter case ignored), or the only one of
/// its kind. What cannot be told is an error (ErrorCode::usage, data) that lists the log's channels.
Result<LogPlan> plan_log(const std::filesystem::path& log, const Rig& rig,
                         const std::map<std::string, std::string>& channels, double tolerance);

/// Loads a view; fails where one of its messages is damaged.
Result<void> load_log_view(const std::filesystem::path& log, const LogGroup& group, const Rig& rig,
                           std::map<std::string, Image>& images, std::map<std::string, Scan>& scans);

}  // namespace ca2
