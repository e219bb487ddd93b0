/// @file From a rig's LiDAR to the driver that decodes it.
#pragma once

#include <filesystem>
#include <string>

#include "core/session/rig.h"
#include "drivers/lidar/lidar_driver.h"

namespace ca2 {

/// `file` is the rig's; `host`: only datagrams from there, empty: from anyone.
Result<LidarDriver> open_lidar_driver(const RigLidar& lidar, const std::filesystem::path& file,
                                      const std::string& host);

}  // namespace ca2
