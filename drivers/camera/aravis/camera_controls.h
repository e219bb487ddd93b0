/// @file The controls of a GenICam camera: exposure, gain, frame rate, trigger.
#pragma once

#include <map>
#include <string>

#include "drivers/camera/aravis/features.h"
#include "drivers/camera/camera_source.h"

namespace ca2 {

/// The controls that the camera has, as they are now: "exposure_us" and "gain_db" (a number or "auto"),
/// "frame_rate" (Hz), "trigger" ("off" or "software").
std::map<std::string, CameraControl> read_controls(const Features& features);

/// Are this control and this value possible, as `controls` (of read_controls) stand? ErrorCode::usage.
Result<void> check_control(const std::map<std::string, CameraControl>& controls, const std::string& name,
                           const std::string& value);

/// Writes one that check_control let pass. The camera has the last word.
Result<void> write_control(const Features& features, const std::string& name, const std::string& value);

/// The rate at which pictures will come, Hz; 0: at triggers, or unknown.
double expected_rate(const Features& features);

}  // namespace ca2
