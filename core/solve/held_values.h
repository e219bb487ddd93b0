/// @file Calibrations that take what is given for exactly right.
#pragma once

#include <vector>

#include "core/solve/calibrate.h"

namespace ca2 {

/// What was measured better than the views could.
struct HeldValues {
  bool intrinsics = false;  ///< of every camera that has given ones
  bool ranges = false;      ///< of every LiDAR: they have no bias

  bool any() const { return intrinsics || ranges; }
};

/// `options` that believe it.
CalibrateOptions holding(CalibrateOptions options, const HeldValues& held);

/// `calibrate` with these, as a note says, and without them: where the answer without is another by more than
/// its covariance allows, the views contradict what was held. Another note says so then, and the verdict is
/// weak.
Result<Calibration> calibrate_holding(const Rig& rig, const std::vector<ViewSights>& views,
                                      const CalibrateOptions& options, const HeldValues& held);

}  // namespace ca2
