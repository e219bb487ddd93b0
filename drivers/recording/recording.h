/// @file Recordings: a directory with the raw input of a whole rig (docs/recording.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/session/rig.h"
#include "core/types/result.h"
#include "drivers/lidar/beam_table.h"

namespace ca2 {

struct Recording {
  std::filesystem::path directory;
  Rig rig;                 ///< paths in it are relative to the directory
  std::int64_t start = 0;  ///< ns UTC

  std::filesystem::path pictures(const std::string& camera) const { return directory / "cameras" / camera; }
  std::filesystem::path packets(const std::string& lidar) const {
    return directory / "lidars" / (lidar + ".pcap");
  }
  /// How the LiDAR's packets are decoded.
  LidarModelSpec model(const std::string& lidar) const;
};

/// Reads recording.yaml. ErrorCode::io where there is none, ErrorCode::config with every problem.
Result<Recording> open_recording(const std::filesystem::path& directory);

/// The text of recording.yaml.
std::string recording_text(const Rig& rig, std::int64_t start);

}  // namespace ca2
