/// @file What the estimator's statistical tests share.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "core/solve/calibrate.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"

namespace ca2 {

/// Corner noise [px] that stands for pictures with a noise of 0.007: there the refinement leaves 0.004 to
/// 0.010 px (refine_test.cpp). The simulator's own default, 0.05 px, is a poor camera's.
constexpr double refined_corner_sigma = 0.010;

/// A scenario of config/scenarios.
inline ScenarioFile load(const std::string& name, std::uint64_t seed) {
  Result<ScenarioFile> file =
      read_scenario(std::string(CA2_SOURCE_DIR "/config/scenarios/") + name + ".yaml");
  if (!file) throw std::runtime_error(file.error().text());
  file->scenario.seed = seed;
  return *std::move(file);
}

inline std::vector<SimulatedView> pool_of(const Scenario& scenario, int count) {
  Result<std::vector<SimulatedView>> pool = simulate_pool(scenario, count);
  if (!pool) throw std::runtime_error(pool.error().text());
  return *std::move(pool);
}

inline Result<Calibration> calibrate_features(const Rig& rig, const std::vector<SimulatedView>& views,
                                              Method method = Method::joint) {
  const Result<std::vector<ViewSights>> sights = sights_of(rig, views);
  if (!sights) return fail(sights.error());
  CalibrateOptions options;
  options.method = method;
  return calibrate(rig, *sights, options);
}

}  // namespace ca2
