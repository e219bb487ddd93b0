/// @file From what was held to what is written.
#pragma once

#include <map>

#include "core/capture/assess.h"
#include "core/capture/held_view.h"
#include "core/capture/pipeline.h"

namespace ca2 {

/// The mean pictures, the scans (shared with the tracks) and the text of view.yaml. `picks`: by LiDAR. The
/// tracks let go of a camera's pictures as soon as their mean is there.
StoreView stored_form(const HeldView& view, Tracks& tracks, const std::map<int, Pick>& picks, int id,
                      bool automatic);

}  // namespace ca2
