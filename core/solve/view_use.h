/// @file Why a view cannot take part, in words for a person.
#pragma once

#include <string>

#include "core/features/sights.h"

namespace ca2 {

/// For a view of which fewer than two sensors are left once the hypotheses were settled.
std::string why_unusable(const ViewSights& view);

}  // namespace ca2
