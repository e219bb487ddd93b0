/// @file The scenarios that benchmarks simulate.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/sim/scenario_file.h"

namespace ca2 {

/// Those with `only` in their names, read from the folder `data`; without one (empty) from config/scenarios,
/// which the source tree has, or else from where packages put them. ErrorCode::data where there is no such
/// folder or a scenario is not in it.
Result<std::vector<ScenarioFile>> bench_scenarios(const std::filesystem::path& data,
                                                  const std::vector<std::string>& names,
                                                  const std::string& only = "");

}  // namespace ca2
