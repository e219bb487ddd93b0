#include "core/solve/view_use.h"

#include <algorithm>

namespace ca2 {

std::string why_unusable(const ViewSights& view) {
  if (!view.problem.empty()) return view.problem;
  const bool camera = std::any_of(view.cameras.begin(), view.cameras.end(),
                                  [](const auto& sight) { return sight.has_value(); });
  const bool lidar =
      std::any_of(view.lidars.begin(), view.lidars.end(), [](const auto& sights) { return !sights.empty(); });
  if (!camera) return "no camera found the board";
  if (!lidar) return "no LiDAR found anything of the board's size";
  return "nothing the LiDAR found sits where the other views say the board is";
}

std::size_t candidate_views(const std::vector<ViewSights>& views, std::size_t lidar) {
  return static_cast<std::size_t>(std::count_if(views.begin(), views.end(), [&](const ViewSights& view) {
    return !view.lidars[lidar].empty() &&
           std::any_of(view.cameras.begin(), view.cameras.end(), [](const auto& c) { return c.has_value(); });
  }));
}

}  // namespace ca2
