/// @file The cells of `ca2 bench accuracy`: one rig, one noise level, one number of views.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/session/calibration.h"
#include "core/solve/held_values.h"
#include "core/types/result.h"
#include "tools/sim/calibration_trials.h"

namespace ca2 {

/// One rig in one state of its sensors.
struct AccuracyExperiment {
  std::string name;
  ScenarioFile file;             ///< with the noise of this experiment
  double least_bias = 0;         ///< m: the range bias of every trial is drawn between these, of either sign
  double most_bias = 0;          ///< m
  int pool = 53;                 ///< views of which each trial draws
  std::vector<int> view_counts;  ///< N of the cells
  HeldValues held = {};          ///< what estimate and bound take for right
};

/// Errors of one method over the trials of a cell.
struct MethodErrors {
  int answers = 0;
  double translation = 0, translation2 = 0;  ///< m, m^2: sums
  double rotation = 0, rotation2 = 0;        ///< rad, rad^2: sums
  double nees = 0;                           ///< sum
  int covered = 0;                           ///< truths within the covariance's 95 % ellipsoid
  /// Sums of the squared error over the bound of the same views (its trace), where there is a bound.
  double ratio_translation2 = 0, ratio_rotation2 = 0;
  int bounded = 0;

  double mean_translation() const { return translation / std::max(1, answers); }  ///< m
  double mean_nees() const { return nees / (6 * std::max(1, answers)); }          ///< 1: honest
  double ratio_translation() const;                                               ///< rms(error / bound)
  double ratio_rotation() const;
};

struct AccuracyCell {
  std::string experiment;
  int views = 0;
  int trials = 0;
  std::map<std::string, MethodErrors> methods;  ///< kim, plane_to_plane, joint, joint with edges
  /// Root mean trace of the bounds; m, rad; 0 without noise.
  double bound_translation = 0, bound_rotation = 0;
  double edge_bound_translation = 0, edge_bound_rotation = 0;

  nlohmann::json json() const;
};

inline constexpr const char* kim_name = "kim";
inline constexpr const char* planes_name = "plane_to_plane";
inline constexpr const char* joint_name = "joint";
inline constexpr const char* edges_name = "joint with edges";

/// Runs `trials` trials: each draws a pool of views, intrinsics errors and biases of its own, and from the
/// pool one subset for every cell, on which all methods run. Subsets that planes alone do not determine are
/// left out for all. `progress` is told after every trial.
Result<std::vector<AccuracyCell>> run_accuracy(const AccuracyExperiment& experiment, int trials,
                                               std::uint64_t seed, const std::function<void(int)>& progress);

}  // namespace ca2
