/// @file Scenario files: the rig keys of a session, and what is true about them (docs/simulator.md).
#pragma once

#include <filesystem>
#include <string>

#include "core/session/rig.h"
#include "tools/sim/scenario.h"

namespace ca2 {

/// What the session tells the solver about the cameras it really has.
struct IntrinsicsError {
  double pixel = 0;   ///< px: the principal point is off by up to this along each axis
  double focal = 0;   ///< relative: both focal lengths are off by one factor of up to this
  bool hide = false;  ///< no intrinsics are given at all
};

struct ScenarioFile {
  std::filesystem::path file;
  Scenario scenario;
  Rig rig;  ///< as written in the file: with the true intrinsics
  IntrinsicsError intrinsics_error;
};

/// Reads a scenario. Every problem is reported with its place; ErrorCode::config. Paths in the file are
/// relative to it.
Result<ScenarioFile> read_scenario(const std::filesystem::path& file);

/// The rig as the session states it: intrinsics perturbed by draws that the scenario's seed settles.
Rig stated_rig(const ScenarioFile& scenario);

}  // namespace ca2
