/// @file What a LiDAR measures in a scene.
#pragma once

#include <random>

#include "core/types/scan.h"
#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {

/// The returns of `LidarNoise::sweeps` revolutions (time runs on), missing ones left out. A beam is a cone:
/// where its footprint lies on two surfaces, their ranges blend, or the stronger echo wins when they are
/// further apart than the pulse is long. Intensity: Velodyne-like calibrated reflectivity 0..100 for a
/// free-running LiDAR, signal falling with the square of the range for the other kind.
Scan simulate_scan(const SimulatedLidar& lidar, const Scene& scene, std::mt19937_64& rng);

}  // namespace ca2
