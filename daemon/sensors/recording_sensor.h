/// @file A recording as the daemon's sensors, in time.
#pragma once

#include <memory>

#include "daemon/sensors/input_sink.h"
#include "daemon/sensors/sensor_device.h"
#include "drivers/recording/recording.h"

namespace ca2 {

/// Stamps stay those of the recording: the daemon's clock begins with it.
std::unique_ptr<SensorDevice> make_recording_sensor(const Recording& recording, InputSink& sink);

}  // namespace ca2
