/// @file A UDP port and the LiDARs that send to it.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/session/rig.h"
#include "daemon/sensors/input_sink.h"
#include "daemon/sensors/sensor_device.h"

namespace ca2 {

/// One device per socket that the rig's LiDARs need; `file` is the rig's, `state` is where sensors' metadata
/// is kept (ouster_metadata.h), `sink` outlives them.
std::vector<std::unique_ptr<SensorDevice>> make_lidar_sensors(const Rig& rig,
                                                              const std::filesystem::path& file,
                                                              const std::filesystem::path& state,
                                                              InputSink& sink);

}  // namespace ca2
