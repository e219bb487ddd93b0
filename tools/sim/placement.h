/// @file Draws places for the board within the shared field of view of a rig.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/types/result.h"
#include "tools/sim/plate.h"
#include "tools/sim/scenario.h"

namespace ca2 {

/// A beam that meets the plate.
struct PlateHit {
  int ring = 0;
  int column = 0;
  BeamRay ray;              ///< LiDAR frame, with the azimuth as it really was
  double range = 0;         ///< m, true
  Eigen::Vector2d p_board;  ///< m
};

/// Every beam that meets the plate within the LiDAR's range. `azimuth` [rad] turns the beams about the
/// LiDAR's z axis: where in its column grid a free-running revolution began.
std::vector<PlateHit> cast_on_plate(const BeamTable& beams, double azimuth, const Pose& T_lidar_board,
                                    const Plate& plate);

/// The offset of one revolution for `cast_on_plate`: uniform within a column, zero for a locked encoder.
double draw_azimuth(const SimulatedLidar& lidar, std::mt19937_64& rng);

/// T_rig_board of a random place that all `sensors` see, with the print towards them. Fails with
/// ErrorCode::config when none is found: the field of view is not shared as the scenario claims.
Result<Pose> place_board(const Scenario& scenario, const std::vector<std::string>& sensors,
                         std::mt19937_64& rng);

}  // namespace ca2
