/// @file What a rig's `source:` mappings ask for, judged without opening a device.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/session/rig.h"

namespace ca2 {

/// Where a LiDAR's datagrams come in: the `source:` mapping, understood.
struct LidarAddress {
  std::string host;             ///< numeric address of the sensor; empty: whoever sends to the port
  std::uint16_t port = 0;       ///< UDP
  std::string local_address;    ///< to receive on; empty: all
  std::string multicast_group;  ///< empty: none
  std::string interface;        ///< for the group
};

/// `problems` gets what is wrong, with the LiDAR's name.
LidarAddress read_lidar_address(const std::string& name, const RigLidar& lidar,
                                std::vector<Problem>& problems);

/// Every problem of every sensor's source, and of the files that LiDARs are decoded with.
std::vector<Problem> check_sources(const Rig& rig, const std::filesystem::path& file);

/// A rig's path, which is relative to the file that it was read from.
std::filesystem::path resolve(const std::string& path, const std::filesystem::path& rig_file);

}  // namespace ca2
