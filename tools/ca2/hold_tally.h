/// @file How well a simulated recording's holds were captured, against its truth.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/session/session.h"

namespace ca2 {

struct HoldTally {
  int holds = 0, captured = 0;
  int moving = 0;      ///< views taken outside every hold
  int wrong = 0;       ///< sights in views, none of whose hypotheses is the board where it was
  int twice = 0;       ///< holds with more than one view
  double longest = 0;  ///< s from the board's standstill until the view was stored, of the slowest

  std::string text() const;
};

/// `stored`: ns UTC of the recording's clock at which each view was stored. Nothing where `truth` has no
/// holds.
Result<std::optional<HoldTally>> tally_holds(const std::filesystem::path& truth, const Session& session,
                                             const std::map<int, std::int64_t>& stored);

}  // namespace ca2
