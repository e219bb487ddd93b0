/// @file Small rigs for the simulator's tests.
#pragma once

#include <cmath>
#include <numbers>

#include "tools/sim/scenario.h"

namespace ca2 {

/// Evenly spread rings between two elevations [rad], all beams from the origin.
inline BeamTable even_beams(int rings, int columns, double lowest, double highest) {
  BeamTable beams;
  beams.model = "even";
  beams.rings = rings;
  beams.columns = columns;
  beams.range_quantum = 0.002;
  beams.min_range = 0.3;
  beams.max_range = 100;
  for (int ring = 0; ring < rings; ++ring) {
    const double elevation = lowest + (highest - lowest) * ring / (rings - 1);
    for (int column = 0; column < columns; ++column) {
      const double azimuth = -2 * std::numbers::pi * column / columns;
      beams.rays.push_back({Eigen::Vector3d::Zero(),
                            {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                             std::sin(elevation)}});
      beams.time.push_back(column / (beams.rate * columns));
    }
  }
  return beams;
}

/// A camera's axes (z forward) on a body with x forward, z up.
inline Eigen::Matrix3d optical_axes() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

/// A 16-ring LiDAR 0.2 m over a radtan camera with a checkerboard of 8 x 6 corners, 80 mm.
inline Scenario small_scenario() {
  Scenario scenario;
  scenario.name = "small";
  scenario.board.type = find_board_type("checkerboard");
  scenario.board.columns = 8;
  scenario.board.rows = 6;
  scenario.board.square = 0.08;
  scenario.board.outline = Outline{0.84, 0.594, {0.004, -0.002}};
  SimulatedCamera camera;
  camera.camera.model = find_camera_model("pinhole_radtan");
  camera.camera.parameters.resize(9);
  camera.camera.parameters << 820, 825, 641.3, 478.9, -0.11, 0.07, 0.0004, -0.0003, 0;
  camera.camera.width = 1280;
  camera.camera.height = 960;
  camera.T_rig_camera = {optical_axes() * so3_exp({0.02, -0.03, 0.01}), {0.05, 0.02, -0.2}};
  scenario.cameras["front"] = camera;
  SimulatedLidar lidar;
  lidar.beams = even_beams(16, 1800, -0.26, 0.26);
  scenario.lidars["top"] = lidar;
  scenario.placement.min_distance = 1.5;
  scenario.placement.max_distance = 3.5;
  scenario.room = Room{};
  return scenario;
}

}  // namespace ca2
