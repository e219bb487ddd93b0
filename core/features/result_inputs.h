/// @file Whether a result still is that of the session it lies in.
#pragma once

#include <optional>
#include <vector>

#include "core/session/calibration.h"
#include "core/session/session.h"

namespace ca2 {

/// What the session holds now, for a result that is made of its views with the `asked` ids (empty: of all).
/// Contents count, neither times nor places: a session may be copied. `cache`: digests of files whose size
/// and time of change are those that SESSION/cache knows are taken from there, so that a second solve reads
/// no picture.
CalibrationInputs result_inputs(const Session& session, const std::vector<int>& asked, bool cache = true);

/// A warning that the session is not what the result was made of any more, which says what changed. Nothing
/// where nothing did, or where the result does not say what it was made of. A view that is gone is missed if
/// it was used.
std::optional<Problem> outdated_result(const Calibration& calibration, const Session& session);

}  // namespace ca2
