/// @file From what the sensors saw to the calibration of the rig, by any of the methods.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/session/calibration.h"
#include "core/session/rig.h"
#include "core/solve/joint_solver.h"
#include "core/solve/sights.h"
#include "core/types/result.h"

namespace ca2 {

enum class Method { joint, plane_to_plane, kim };

struct CalibrateOptions {
  Method method = Method::joint;
  std::uint64_t seed = 1;
  JointOptions joint;
};

/// The rig's cameras must all have intrinsics here (estimated ones count; `estimated` says which, by index in
/// the rig's order, with their standard deviations). The views' sensors are indexed in the rig's order (by
/// name). Refusals (ErrorCode::refused) say what the views cannot determine and which pose of the board would
/// cure it.
Result<Calibration> calibrate(const Rig& rig, const std::vector<ViewSights>& views,
                              const CalibrateOptions& options);

}  // namespace ca2
