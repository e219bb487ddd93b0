#include "core/capture/known_extrinsics.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

// How far a patch's centre and plane may be off by themselves: rings that lie far apart, few returns.
constexpr double sight_distance = 0.12;  // m
constexpr double sight_angle = 0.25;     // rad
// What a person who measured with a tape may be off by.
constexpr double guess_distance = 0.3, guess_angle = 0.3;
// A solve with fewer agreeing views may have agreed by chance.
constexpr int enough_views = 5;

}  // namespace

KnownExtrinsics::KnownExtrinsics(const Rig& rig) {
  for (const RigExtrinsic& known : rig.extrinsics) {
    ExtrinsicGuess guess{known.T_parent_child, sight_distance, sight_angle};
    if (!known.fixed) guess.distance += guess_distance, guess.angle += guess_angle;
    if (rig.cameras.contains(known.parent) && rig.lidars.contains(known.child)) {
      rig_.push_back({known.parent, known.child, guess});
    } else if (rig.lidars.contains(known.parent) && rig.cameras.contains(known.child)) {
      guess.T_camera_lidar = known.T_parent_child.inverse();
      rig_.push_back({known.child, known.parent, guess});
    }
  }
}

void KnownExtrinsics::update(const Calibration& calibration) {
  const auto used = std::count_if(calibration.views.begin(), calibration.views.end(),
                                  [](const CalibratedView& view) { return view.used; });
  solved_.clear();
  if (used < enough_views) return;
  for (const CalibratedTransform& transform : calibration.transforms) {
    const double distance = sight_distance + 3 * transform.sigma_translation();
    const double angle = sight_angle + 3 * transform.sigma_rotation();
    if (!(distance < 2 * guess_distance) || !(angle < 2 * guess_angle)) continue;
    solved_.push_back({transform.parent, transform.child, {transform.T_parent_child, distance, angle}});
  }
}

std::optional<ExtrinsicGuess> KnownExtrinsics::between(const std::string& camera,
                                                       const std::string& lidar) const {
  for (const std::vector<Entry>* list : {&solved_, &rig_}) {
    for (const Entry& entry : *list) {
      if (entry.camera == camera && entry.lidar == lidar) return entry.guess;
    }
  }
  return std::nullopt;
}

double disagreement(const ExtrinsicGuess& guess, const Pose& T_camera_board, const Board& board,
                    const LidarSight& sight) {
  const Eigen::Vector2d& plate = board.extent().center;
  const Pose T_lidar_board = guess.T_camera_lidar.inverse() * T_camera_board;
  const Eigen::Vector3d center = T_lidar_board * Eigen::Vector3d(plate.x(), plate.y(), 0);
  const double cosine = board_plane(T_lidar_board).normal.dot(sight.plane.normal);
  return std::max((center - sight.center).norm() / guess.distance,
                  std::acos(std::clamp(cosine, -1.0, 1.0)) / guess.angle);
}

}  // namespace ca2
