/// @file A camera device, with all of its imagers that the rig uses.
#pragma once

#include <memory>

#include "core/session/rig.h"
#include "daemon/sensors/input_sink.h"
#include "daemon/sensors/sensor_device.h"
#include "drivers/camera/camera_driver.h"

namespace ca2 {

/// `sink` outlives it.
std::unique_ptr<SensorDevice> make_camera_sensor(const Rig& rig, const CameraDevice& device, InputSink& sink);

}  // namespace ca2
