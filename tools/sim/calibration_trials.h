/// @file One calibration against the truth, from simulated features: what accuracy tests and benchmarks
/// repeat.
#pragma once

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/session/calibration.h"
#include "core/session/rig.h"
#include "tools/sim/feature_simulator.h"
#include "tools/sim/scenario_file.h"

namespace ca2 {

/// How far an answer is from the truth.
struct TransformError {
  double translation = 0;  ///< m
  double rotation = 0;     ///< rad
  /// Squared error over the covariance: chi-squared with 6 degrees of freedom when the covariance is right.
  double nees = 0;
};

/// T_parent_child of two of the scenario's sensors.
Pose true_transform(const Scenario& scenario, const std::string& parent, const std::string& child);

TransformError error_of(const CalibratedTransform& transform, const Pose& T_parent_child);

/// The worst pair's (by NEES) of all camera-LiDAR transforms of a calibration.
TransformError worst_error(const Calibration& calibration, const Scenario& scenario);

/// `rig` with its cameras' focal lengths and principal points off by uniform draws within `error`.
Rig misstated_rig(Rig rig, const IntrinsicsError& error, std::mt19937_64& rng);

/// Views with numbers 1 .. count, each from its own generator. ErrorCode::config where the board has no
/// place.
Result<std::vector<SimulatedView>> simulate_pool(Scenario scenario, int count);

/// `count` different views of the pool, drawn at random.
template <class View>
std::vector<View> draw_subset(const std::vector<View>& pool, int count, std::mt19937_64& rng) {
  std::vector<std::size_t> order(pool.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), rng);
  std::vector<View> subset;
  for (int i = 0; i < count; ++i) subset.push_back(pool[order[static_cast<std::size_t>(i)]]);
  return subset;
}

}  // namespace ca2
