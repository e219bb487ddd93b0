#include "core/guidance/next_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/guidance/candidate_poses.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

// Corners are known no better than the lens' model is, whatever their noise.
constexpr double least_corner_sigma = 0.03;   // px
constexpr double default_range_sigma = 0.01;  // m
// Of a LiDAR never calibrated: enough that the sums are finite.
constexpr double vague_bias = 0.02;  // m

/// A board that a camera and a LiDAR both saw.
struct Seen {
  Pose T_camera_board;
  std::size_t returns = 0;
};

/// The views in use that both sensors have; of the LiDAR's hypotheses the one nearest to where the camera has
/// the board.
std::vector<Seen> views_of_pair(const Calibration& calibration, const std::vector<ViewSights>& views,
                                std::size_t camera, std::size_t lidar, const Pose& T_camera_lidar) {
  std::vector<Seen> seen;
  for (const ViewSights& view : views) {
    const bool used = std::any_of(calibration.views.begin(), calibration.views.end(),
                                  [&](const auto& v) { return v.id == view.id && v.used; });
    if (!used || !view.cameras[camera] || view.lidars[lidar].empty()) continue;
    const Pose& T_camera_board = view.cameras[camera]->pose.T_camera_board;
    const Eigen::Vector3d centre = T_camera_lidar.inverse() * T_camera_board.t;
    const auto nearest = std::min_element(view.lidars[lidar].begin(), view.lidars[lidar].end(),
                                          [&](const LidarSight& a, const LidarSight& b) {
                                            return (a.center - centre).norm() < (b.center - centre).norm();
                                          });
    seen.push_back({T_camera_board, nearest->on_board.size()});
  }
  return seen;
}

double returns_per_steradian(const std::vector<Seen>& seen, const Outline& extent,
                             const Pose& T_camera_lidar) {
  std::vector<double> densities;
  for (const Seen& view : seen) {
    const Pose T_lidar_board = T_camera_lidar.inverse() * view.T_camera_board;
    const double distance = T_lidar_board.t.norm();
    const double facing = std::abs(T_lidar_board.R.col(2).dot(T_lidar_board.t)) / distance;
    densities.push_back(static_cast<double>(view.returns) * distance * distance /
                        (extent.width * extent.height * std::max(facing, 0.1)));
  }
  const auto middle = densities.begin() + static_cast<std::ptrdiff_t>(densities.size() / 2);
  std::nth_element(densities.begin(), middle, densities.end());
  return *middle;
}

const CalibratedTransform* worst_pair(const Rig& rig, const Calibration& calibration,
                                      const SigmaTarget& target) {
  const auto cost = [&](const CalibratedTransform& t) {
    return std::pow(t.sigma_translation() / target.translation, 2) +
           std::pow(t.sigma_rotation() / target.rotation, 2);
  };
  const CalibratedTransform* worst = nullptr;
  for (const CalibratedTransform& transform : calibration.transforms) {
    if (rig.cameras.count(transform.parent) == 0 || rig.lidars.count(transform.child) == 0) continue;
    if (worst == nullptr || cost(transform) > cost(*worst)) worst = &transform;
  }
  return worst;
}

template <class Map>
std::size_t index_of(const Map& map, const std::string& name) {
  return static_cast<std::size_t>(std::distance(map.begin(), map.find(name)));
}

int rounded_degrees(double angle) {
  return 5 * static_cast<int>(std::lround(angle * 180 / M_PI / 5));
}

}  // namespace

std::string pose_in_words(const Pose& T_camera_board) {
  const Eigen::Vector3d& p = T_camera_board.t;
  const double azimuth = std::atan2(p.x(), p.z());
  const double depression = std::atan2(p.y(), std::hypot(p.x(), p.z()));
  constexpr double aside = 8 * M_PI / 180;
  std::string place;
  if (std::abs(azimuth) > aside) place = azimuth > 0 ? "right" : "left";
  if (std::abs(depression) > aside) {
    place += (place.empty() ? "" : " and ") + std::string(depression > 0 ? "low" : "high");
  }
  if (place.empty()) place = "in the middle";

  // The side the camera sees faces back along z; turned against straight at the camera.
  const Eigen::Vector3d n = -T_camera_board.R.col(2);
  const Eigen::Vector3d straight = -p.normalized();
  const double turned = std::atan2(n.x(), -n.z()) - std::atan2(straight.x(), -straight.z());
  const double raised =
      std::asin(std::clamp(-n.y(), -1.0, 1.0)) - std::asin(std::clamp(-straight.y(), -1.0, 1.0));
  std::string direction;
  if (const int degrees = rounded_degrees(std::abs(turned)); degrees >= 10) {
    direction = formatted("%d degrees %s of", degrees, turned > 0 ? "right" : "left");
  }
  if (const int degrees = rounded_degrees(std::abs(raised)); degrees >= 10) {
    direction += (direction.empty() ? "" : " and ") +
                 formatted("%d degrees %s", degrees, raised > 0 ? "above" : "below");
  }
  return formatted("%s, %.1f m away, facing %s the camera", place.c_str(), p.norm(),
                   direction.empty() ? "straight at" : direction.c_str());
}

std::optional<NextPose> suggest_next_pose(const Rig& rig, const Calibration& calibration,
                                          const std::vector<ViewSights>& views,
                                          const std::vector<ElevationRange>& lidars,
                                          const SigmaTarget& target) {
  const CalibratedTransform* pair = worst_pair(rig, calibration, target);
  if (pair == nullptr) return std::nullopt;
  const std::size_t c = index_of(rig.cameras, pair->parent);
  const std::size_t l = index_of(rig.lidars, pair->child);
  const auto camera = calibration.cameras.find(pair->parent);
  const auto lidar = calibration.lidars.find(pair->child);
  const std::vector<Seen> seen = views_of_pair(calibration, views, c, l, pair->T_parent_child);
  if (seen.empty() || camera == calibration.cameras.end()) return std::nullopt;

  SightModel model;
  model.board = rig.board;
  model.camera = camera->second.camera;
  model.T_camera_lidar = pair->T_parent_child;
  model.corner_sigma = std::max(least_corner_sigma, calibration.validation.reprojection_rms);
  model.range_sigma = default_range_sigma;
  if (lidar != calibration.lidars.end() && lidar->second.range_sigma > 0) {
    model.range_sigma = lidar->second.range_sigma;
  }
  model.returns_per_steradian = returns_per_steradian(seen, rig.board.extent(), pair->T_parent_child);
  if (l < lidars.size()) model.lowest = lidars[l].low, model.highest = lidars[l].high;

  PairInformation known = bias_prior(vague_bias);
  for (const Seen& view : seen) known += view_information(model, view.T_camera_board);
  const ExpectedSigma now = expected_sigma(known, target);
  const Pose* best = nullptr;
  ExpectedSigma after;
  after.cost = std::numeric_limits<double>::infinity();
  const std::vector<Pose> candidates = candidate_poses(rig.board, model.camera);
  for (const Pose& pose : candidates) {
    const ExpectedSigma here = expected_sigma(known + view_information(model, pose), target);
    if (here.cost < after.cost) best = &pose, after = here;
  }
  if (best == nullptr) return std::nullopt;
  NextPose next;
  next.words = pose_in_words(*best);
  next.camera = pair->parent;
  next.T_camera_board = *best;
  // The model says by how much the pose helps; how good the answer is now, the solver knows better.
  next.sigma_translation = pair->sigma_translation() * after.translation / now.translation;
  next.sigma_rotation = pair->sigma_rotation() * after.rotation / now.rotation;
  return next;
}

std::optional<NextPose> suggest_first_pose(const Rig& rig, const std::vector<ViewSights>& views) {
  for (const auto& [name, camera] : rig.cameras) {
    if (!camera.intrinsics) continue;
    const std::size_t c = index_of(rig.cameras, name);
    const Pose* best = nullptr;
    double widest = -1;
    const std::vector<Pose> candidates = candidate_poses(rig.board, *camera.intrinsics);
    for (const Pose& pose : candidates) {
      double nearest = M_PI;  // angle to the views' normals; facing the camera straight counts as one of them
      const auto compare = [&](const Eigen::Vector3d& normal) {
        nearest = std::min(nearest, std::acos(std::clamp(normal.dot(pose.R.col(2)), -1.0, 1.0)));
      };
      compare(Eigen::Vector3d::UnitZ());
      for (const ViewSights& view : views) {
        if (view.cameras[c]) compare(view.cameras[c]->pose.T_camera_board.R.col(2));
      }
      // In the middle and near, rather than at the rim where another sensor may see nothing.
      const double here =
          nearest - 0.2 * std::acos(std::clamp(pose.t.normalized().z(), -1.0, 1.0)) - 0.01 * pose.t.norm();
      if (here > widest) best = &pose, widest = here;
    }
    if (best == nullptr) continue;
    return NextPose{pose_in_words(*best), name, *best, std::numeric_limits<double>::infinity(),
                    std::numeric_limits<double>::infinity()};
  }
  return std::nullopt;
}

}  // namespace ca2
