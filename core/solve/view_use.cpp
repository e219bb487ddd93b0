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

std::string few_views_note(std::size_t views) {
  if (views == 1)
    return "one view: the answer rests on the plate's rim and on the print's place on it as the rig has "
           "them, and nothing checks either; show the board twice more, in other places, turned and tipped "
           "by 20 to 40 deg another way each time";
  return "two views: they agree, but the answer rests on the plate's rim as the rig has it; show the board "
         "once or twice more, in another place, turned and tipped by 20 to 40 deg another way";
}

}  // namespace ca2
