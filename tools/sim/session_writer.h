/// @file Writes a simulated session, with the truth beside it.
#pragma once

#include <filesystem>
#include <functional>

#include "core/types/result.h"
#include "tools/sim/scenario_file.h"

namespace ca2 {

/// Creates the session `directory` with all views of the scenario and `truth.yaml`. Views are rendered on all
/// cores; the files do not depend on how many. `progress(done, all)` is called after each view, never from
/// two threads at once.
Result<void> write_simulated_session(const ScenarioFile& scenario, const std::filesystem::path& directory,
                                     const std::function<void(int, int)>& progress = {});

}  // namespace ca2
