/// @file A view from memory to the disk and to what the estimator takes.
#pragma once

#include "core/capture/pipeline.h"
#include "core/session/session.h"

namespace ca2 {

/// Writes the view (as write_view does) and adds it to `session`, and says what is in it, which is left in
/// SESSION/cache too: what extract_view finds in the files, but nothing is read back, and the gathered
/// returns of one LiDAR at a time are in memory. Where the search fails, the view is in the
/// session all the same; where the writing fails, it is not.
Result<ViewSights> store_view(Session& session, const StoreView& view);

}  // namespace ca2
