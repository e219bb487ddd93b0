/// @file The packets of one simulated LiDAR into its capture file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/types/result.h"
#include "tools/sim/person_motion.h"
#include "tools/sim/scenario_file.h"

namespace ca2 {

/// Writes revolutions until the motion ends. The rig of the recording: an Ouster's metadata file is written
/// beside its packets and named in `described`. `start`: ns UTC.
Result<void> write_packets(const ScenarioFile& scenario, const std::string& name, const Scene& room,
                           const PersonMotion& motion, std::int64_t start,
                           const std::filesystem::path& directory);

/// Carries the files that decoding the LiDAR needs into the recording, and names them in its rig.
Result<void> carry_lidar_files(const ScenarioFile& scenario, const std::string& name,
                               const std::filesystem::path& directory, RigLidar& described);

}  // namespace ca2
