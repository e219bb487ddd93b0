/// @file Writes a simulated recording: raw packets and pictures of a person who carries the board, with the
/// truth beside them.
#pragma once

#include <filesystem>
#include <functional>

#include "core/types/result.h"
#include "tools/sim/person_motion.h"
#include "tools/sim/scenario_file.h"

namespace ca2 {

/// Creates the recording `directory` (docs/recording.md). Pictures are rendered on all cores; the files do
/// not depend on how many. `progress(done, all)` pictures, never from two threads at once.
Result<void> write_simulated_recording(const ScenarioFile& scenario, const std::filesystem::path& directory,
                                       const std::function<void(int, int)>& progress = {});

/// The recording's start: a fixed time, so that the same scenario gives the same files. ns UTC
inline constexpr std::int64_t simulated_start = 1'700'000'000'000'000'000;

}  // namespace ca2
