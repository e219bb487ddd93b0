/// @file The metadata of an Ouster whose rig names no file: asked of the sensor, and kept.
#pragma once

#include <filesystem>

#include "core/session/rig.h"
#include "core/types/result.h"
#include "drivers/lidar_config/ouster_config.h"

namespace ca2 {

/// Must the sensor be asked? An Ouster with a host, whose rig names no metadata.
bool asks_for_metadata(const RigLidar& lidar);

/// STATE/lidars/NAME.json: where a sensor's answer is kept, for recordings and for a day when it does not
/// answer.
std::filesystem::path kept_metadata(const std::filesystem::path& state, const std::string& lidar);

/// The rig with these files named where the sensors will be asked.
Rig with_kept_metadata(Rig rig, const std::filesystem::path& state);

/// Asks the sensor and keeps its answer in `file`. Where it does not answer, a file from before serves.
/// ErrorCode::unavailable where there is neither.
Result<void> fetch_metadata(const std::string& host, const std::filesystem::path& file,
                            const OusterConfigOptions& options = {});

}  // namespace ca2
