/// @file What the person is asked to show next.
#pragma once

#include <optional>
#include <vector>

#include "core/capture/assess.h"
#include "core/capture/options.h"
#include "core/guidance/next_pose.h"

namespace ca2 {

struct GuidanceSetting {
  const Rig& rig;
  const Tracks& tracks;  ///< their newest scans tell where the LiDARs look
  const CaptureOptions& options;
};

/// Nothing once the target is reached.
std::optional<NextPose> next_view(const GuidanceSetting& setting,
                                  const std::optional<Calibration>& calibration,
                                  const std::vector<ViewSights>& views);

}  // namespace ca2
