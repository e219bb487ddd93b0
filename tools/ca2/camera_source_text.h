/// @file Cameras as a person writes them on a command line, and as they are listed.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "drivers/camera/camera_driver.h"

namespace ca2 {

/// "v4l2:id=/dev/video0,width=640" is a rig's `source: {driver: v4l2, id: /dev/video0, width: 640}`.
Result<SourceOptions> parse_camera_source(const std::string& text);
/// The other way.
std::string camera_source_text(const SourceOptions& source);

/// The drivers and their options, for --help.
std::string camera_drivers_help();

/// The cameras that are there. `controls`: opens each and tells its controls.
nlohmann::json cameras_json(const CameraListing& listing, bool controls);
void print_cameras(const nlohmann::json& cameras);

}  // namespace ca2
