/// @file The solve that the capture pipeline asks for, as `ca2 solve` does it.
#pragma once

#include <stop_token>

#include "core/capture/pipeline.h"

namespace ca2 {

/// Estimates the intrinsics that the rig does not give, then calibrates. Refusals are those of the two.
/// Takes long: hosts run it beside their loop. Asked to stop it fails soon, with ErrorCode::unavailable.
Result<Calibration> solve_views(const SolveViews& request, const std::stop_token& stop = {});

}  // namespace ca2
