#include "core/capture/known_poses.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace ca2 {
namespace {

// Less tells little that the other view has not told, noise apart.
constexpr double least_turn = 0.1;   // rad
constexpr double least_shift = 0.1;  // of the distance; of the board's size in the picture without intrinsics

bool same_pose(const Pose& a, const Pose& b) {
  const Vector6d d = a.difference(b);
  return d.head<3>().norm() < least_turn && d.tail<3>().norm() < least_shift * a.t.norm();
}

bool same_corners(const std::vector<Corner>& a, const std::vector<Corner>& b) {
  std::map<int, Eigen::Vector2d> places;
  for (const Corner& corner : a) places[corner.id] = corner.pixel;
  double apart = 0, size = 0, count = 0;
  for (const Corner& corner : b) {
    const auto at = places.find(corner.id);
    if (at == places.end()) continue;
    apart += (at->second - corner.pixel).norm();
    size = std::max(size, (corner.pixel - b.front().pixel).norm());
    ++count;
  }
  return count >= 4 && apart / count < least_shift * size;
}

}  // namespace

void KnownPoses::remove(int id) {
  std::erase_if(views_, [&](const ViewPose& view) { return view.id == id; });
}

std::optional<int> KnownPoses::find_same(const ViewPose& pose) const {
  for (const ViewPose& view : views_) {
    if (!std::includes(view.lidars.begin(), view.lidars.end(), pose.lidars.begin(), pose.lidars.end()))
      continue;
    bool seen = false, same = true;
    for (std::size_t c = 0; c < pose.corners.size() && same; ++c) {
      if (pose.corners[c].empty()) continue;
      seen = true;
      if (pose.T_camera_board[c] && view.T_camera_board[c])
        same = same_pose(*pose.T_camera_board[c], *view.T_camera_board[c]);
      else
        same = same_corners(pose.corners[c], view.corners[c]);
    }
    if (seen && same) return view.id;
  }
  return std::nullopt;
}

ViewPose pose_of_view(const ViewSights& sights, const std::vector<bool>& intrinsics) {
  ViewPose pose;
  pose.id = sights.id;
  for (std::size_t c = 0; c < sights.cameras.size(); ++c) {
    const std::optional<CameraSight>& sight = sights.cameras[c];
    pose.corners.push_back(sight ? sight->corners : std::vector<Corner>());
    pose.T_camera_board.push_back(sight && intrinsics[c] ? std::optional(sight->pose.T_camera_board)
                                                         : std::nullopt);
  }
  for (std::size_t l = 0; l < sights.lidars.size(); ++l) {
    if (!sights.lidars[l].empty()) pose.lidars.insert(static_cast<int>(l));
  }
  return pose;
}

}  // namespace ca2
