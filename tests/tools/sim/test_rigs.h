/// @file Small rigs for the simulator's tests.
#pragma once

#include <filesystem>

#include "tools/sim/scenario.h"

namespace ca2 {

/// A camera's axes (z forward) on a body with x forward, z up.
inline Eigen::Matrix3d optical_axes() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

/// The scenarios that are shipped.
inline std::filesystem::path scenario_directory() {
  return std::filesystem::path(CA2_SOURCE_DIR) / "config/scenarios";
}

/// A VLP-16 0.2 m over a radtan camera with a checkerboard of 8 x 6 corners, 80 mm.
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
  lidar.beams = make_beam_table({"VLP-16", {}, {}, 10, 0}).value();
  // Velodyne's own frame: x right, y forward.
  lidar.T_rig_lidar.R << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  scenario.lidars["top"] = lidar;
  scenario.placement.min_distance = 1.5;
  scenario.placement.max_distance = 3.5;
  scenario.room = Room{};
  return scenario;
}

}  // namespace ca2
