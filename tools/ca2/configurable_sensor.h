/// @file A LiDAR that answers over the network, whichever vendor's it is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar_config/ouster_config.h"
#include "drivers/lidar_config/velodyne_config.h"

namespace ca2 {

/// One of the two is there.
struct ConfigurableSensor {
  std::optional<OusterConfig> ouster;
  std::optional<VelodyneConfig> velodyne;

  const char* vendor() const { return ouster ? "Ouster" : "Velodyne"; }
  Result<std::vector<SettingChange>> plan(const std::vector<Setting>& wanted) const;
  Result<void> apply(const std::vector<SettingChange>& changes, bool persist) const;
  /// What decoding needs to know (Ouster), or the snapshot (Velodyne): a JSON object.
  Result<std::string> read_metadata() const;
  /// Who it is: sensor_info (Ouster), or info.json (Velodyne).
  Result<std::string> read_identity() const;
};

/// `address`: HOST, or HOST:PORT of its web server; `vendor`: "ouster", "velodyne", or "auto" for whichever
/// answers.
Result<ConfigurableSensor> connect_sensor(const std::string& address, const std::string& vendor);

}  // namespace ca2
