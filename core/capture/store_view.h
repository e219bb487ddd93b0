/// @file A view from memory to the disk and to what the estimator takes.
#pragma once

#include <functional>

#include "core/capture/pipeline.h"
#include "core/session/session.h"

namespace ca2 {

/// What store_view does at the moment, for who measures what it costs.
enum class StoreStep { saving, searching };
using StoreProgress = std::function<void(StoreStep)>;

/// Writes the view (as write_view does) and adds it to `session`, and says what is in it, which is left in
/// SESSION/cache too: what extract_view finds in the files, but nothing is read back. Where the writing
/// fails, it is not in the session and can be stored again. Once it is on the disk, pictures and scans are
/// let go of as they are searched; where the search fails, it is in the session all the same. `progress` is
/// told of every step that begins.
Result<ViewSights> store_view(
    Session& session, StoreView& view, const StoreProgress& progress = [](StoreStep) {});

}  // namespace ca2
