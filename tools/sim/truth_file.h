/// @file truth.yaml: what is true about simulated data.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/sim/person_motion.h"
#include "tools/sim/scenario.h"

namespace ca2 {

struct ViewTruth {
  int id = 0;
  WrongObject wrong_object = WrongObject::none;
  std::map<std::string, Pose> T_sensor_board;  ///< by sensor of the view
};

/// The text of truth.yaml (docs/simulator.md), with 17 significant digits: true transforms of every camera
/// and LiDAR, true intrinsics, noise of the LiDARs, and the views.
std::string truth_text(const Scenario& scenario, const std::vector<ViewTruth>& views);

/// The holds of a recording, to follow truth_text: ids, ns UTC from and to, T_sensor_board. `start`: ns UTC.
std::string holds_text(const Scenario& scenario, const std::vector<TrueHold>& holds, std::int64_t start);

/// A hold as read back.
struct RecordedHold {
  int id = 0;
  std::int64_t from = 0, to = 0;  ///< ns UTC
  std::map<std::string, Pose> T_sensor_board;
};
Result<std::vector<RecordedHold>> read_true_holds(const std::filesystem::path& file);

struct TrueTransform {
  std::string parent, child;
  Pose T_parent_child;
};

/// The transforms of a truth.yaml, to measure an answer against.
Result<std::vector<TrueTransform>> read_true_transforms(const std::filesystem::path& file);

}  // namespace ca2
