/// @file What a person is told of one sensor.
#pragma once

#include "core/capture/assess.h"
#include "core/capture/status.h"

namespace ca2 {

/// Of the camera or LiDAR with this index in the rig's order, at a time, ns UTC.
SensorStatus camera_status(const Tracks& tracks, std::size_t camera, const CaptureOptions& options,
                           std::int64_t time);
SensorStatus lidar_status(const Tracks& tracks, std::size_t lidar, const CaptureOptions& options,
                          std::int64_t time);

}  // namespace ca2
