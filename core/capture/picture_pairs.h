/// @file Pictures that the cameras of a rig took together.
#pragma once

#include <vector>

#include "core/capture/observation.h"

namespace ca2 {

/// By camera, pictures by rising time. Where the cameras were triggered together, the pictures whose partners
/// were lost are left out: hands tremble, and means over different moments show different places. Cameras
/// that run on their own keep what they have.
void keep_pairs(std::vector<std::vector<const CameraObservation*>>& cameras);

}  // namespace ca2
