/// @file Which views can take part, and why one cannot, in words for a person.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/features/sights.h"

namespace ca2 {

/// For a view of which fewer than two sensors are left once the hypotheses were settled.
std::string why_unusable(const ViewSights& view);

/// In how many views LiDAR `lidar` and any camera had something to offer.
std::size_t candidate_views(const std::vector<ViewSights>& views, std::size_t lidar);

/// What an answer by the rims of one or two views is worth, and what to show next.
std::string few_views_note(std::size_t views);

}  // namespace ca2
