/// @file Views as a perfect extraction would give them - noisy corners and noisy returns from the board -
/// without rendering anything: thousands of calibrations per minute for statistical tests.
#pragma once

#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/lidar/edge_crossings.h"
#include "core/types/scan.h"
#include "tools/sim/scenario.h"

namespace ca2 {

struct SimulatedView {
  /// By camera: all corners that are inside the picture, with Gaussian noise of CameraNoise::corner_sigma
  /// and the covariance that says so.
  std::map<std::string, std::vector<Corner>> corners;
  /// By LiDAR: one return per beam that meets the plate, with range noise, biases and quantisation.
  std::map<std::string, Scan> board_returns;
  /// By LiDAR: the beam of each return, LiDAR frame.
  std::map<std::string, std::vector<BeamRay>> rays;
  /// By LiDAR, of each return: where on the z axis its beam begins, m.
  std::map<std::string, std::vector<float>> heights;
  /// By LiDAR: where its rings enter and leave the plate, LiDAR frame.
  std::map<std::string, std::vector<EdgeCrossing>> crossings;
  /// By sensor: where the board really was, also where a LiDAR saw something else (`wrong_object`).
  std::map<std::string, Pose> T_sensor_board;
  WrongObject wrong_object = WrongObject::none;  ///< why the returns are not from the board's true place
};

/// One view of the scenario at a random place seen by all sensors of the group of `view` (numbered from 1);
/// only they have entries. In `wrong_fraction` of the views the returns come from a plate at an unrelated
/// place. ErrorCode::config when the scenario has no place for the board.
Result<SimulatedView> simulate_features(const Scenario& scenario, std::mt19937_64& rng, int view = 1);

/// The same for all sensors with the board at a chosen place: for tests that need particular poses. A sensor
/// that does not see it has an empty entry.
SimulatedView observe_features(const Scenario& scenario, const Pose& T_rig_board, std::mt19937_64& rng);

/// The views 1 .. scenario.views, each from its own generator (`view_generator`).
Result<std::vector<SimulatedView>> simulate_feature_views(const Scenario& scenario);

/// Re-expresses everything of one LiDAR in another frame: for tests over arbitrary relative rotations, which
/// no real mounting allows with the board still in the beams. Its z axis is then none that beams begin on.
void change_lidar_frame(SimulatedView& view, const std::string& lidar, const Pose& T_new_old);

}  // namespace ca2
