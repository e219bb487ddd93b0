/// @file Finding, opening and letting go of GenICam cameras through Aravis.
#pragma once

#include <string>
#include <vector>

#include "drivers/camera/aravis/glib.h"
#include "drivers/camera/camera_driver.h"

namespace ca2 {

/// Asks the networks and the USB buses: takes about a second.
std::vector<FoundCamera> find_aravis_cameras();

/// Opens a camera for control, by the id, serial number, IP or MAC address; empty: the only one. A controller
/// that crashed holds a camera until its heartbeat is over (3 s), so that a camera that is taken is tried for
/// longer. ErrorCode::unavailable, with the cameras that are there.
Result<GObjectPtr<ArvDevice>> open_aravis_device(const std::string& id);

/// "Allied Vision Technologies Manta G-145B, serial 50-0503..., firmware 1.2".
std::string describe_aravis_device(ArvDevice* device);

}  // namespace ca2
