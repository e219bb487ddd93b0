/// @file The solve that the capture pipeline asks for, as `ca2 solve` does it.
#pragma once

#include "core/capture/pipeline.h"

namespace ca2 {

/// Estimates the intrinsics that the rig does not give, then calibrates. Refusals are those of the two.
/// Takes long: hosts run it beside their loop.
Result<Calibration> solve_views(const SolveViews& request);

}  // namespace ca2
