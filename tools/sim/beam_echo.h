/// @file What comes back to a LiDAR along one beam.
#pragma once

#include <optional>

#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {

/// A return, before the receiver's noise.
struct Echo {
  double range = 0;         ///< m
  double reflectivity = 0;  ///< diffuse
  double energy = 0;        ///< what comes back, relative to white at 1 m seen square on
};

/// What a surface sends back to an infinitely thin beam.
Echo echo_of(const Scene& scene, const SolidHit& hit, const Eigen::Vector3d& direction);

/// Can the beam's footprint touch the plate? Asked beside the neighbours (beam_echo's caller knows them), as
/// rings next to each other in elevation may look into different azimuths (HDL-64E).
bool near_plate(const Solid& plate, const LidarNoise& noise, const Eigen::Vector3d& origin,
                const Eigen::Vector3d& direction);

/// The return of a beam as the cone it is: where its footprint lies on two surfaces, their ranges blend, or
/// the stronger echo wins when they are further apart than the pulse is long. `axis`: what the cone's axis
/// meets; origin and direction in the rig frame.
std::optional<Echo> cone_echo(const Scene& scene, const LidarNoise& noise, const SolidHit& axis,
                              const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

}  // namespace ca2
