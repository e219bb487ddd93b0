/// @file What one calibration costs, for `ca2 bench accuracy`.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/types/result.h"
#include "tools/sim/scenario_file.h"

namespace ca2 {

/// CPU time of one whole calibration of `count` views with edges, features extracted, one thread: median of
/// `repeats`; printed unless `quiet`.
Result<nlohmann::json> calibration_time(const ScenarioFile& file, int count, int repeats, bool quiet);

}  // namespace ca2
