#include "core/guidance/pair_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/guidance/choose_views.h"

namespace ca2 {
namespace {

// Corners are known no better than the lens' model is, whatever their noise.
constexpr double least_corner_sigma = 0.03;   // px
constexpr double default_range_sigma = 0.01;  // m
// Of a LiDAR never calibrated: enough that the sums are finite.
constexpr double vague_bias = 0.02;  // m

/// A board that a camera and a LiDAR both saw.
struct Seen {
  int id = 0;
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
    seen.push_back({view.id, T_camera_board, nearest->on_board.size()});
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

}  // namespace

std::optional<PairModel> worst_pair_model(const Rig& rig, const Calibration& calibration,
                                          const std::vector<ViewSights>& views,
                                          const std::vector<ElevationRange>& lidars,
                                          const SigmaTarget& target) {
  const CalibratedTransform* transform = worst_pair(rig, calibration, target);
  if (transform == nullptr) return std::nullopt;
  const std::size_t c = index_of(rig.cameras, transform->parent);
  const std::size_t l = index_of(rig.lidars, transform->child);
  const auto camera = calibration.cameras.find(transform->parent);
  const auto lidar = calibration.lidars.find(transform->child);
  const std::vector<Seen> seen = views_of_pair(calibration, views, c, l, transform->T_parent_child);
  if (seen.empty() || camera == calibration.cameras.end()) return std::nullopt;

  PairModel pair;
  pair.transform = *transform;
  SightModel& model = pair.model;
  model.board = rig.board;
  model.camera = camera->second.camera;
  model.T_camera_lidar = transform->T_parent_child;
  model.corner_sigma = std::max(least_corner_sigma, calibration.validation.reprojection_rms);
  model.range_sigma = default_range_sigma;
  if (lidar != calibration.lidars.end() && lidar->second.range_sigma > 0) {
    model.range_sigma = lidar->second.range_sigma;
  }
  model.returns_per_steradian = returns_per_steradian(seen, rig.board.extent(), transform->T_parent_child);
  if (l < lidars.size()) model.lowest = lidars[l].low, model.highest = lidars[l].high;
  pair.prior = bias_prior(vague_bias);
  pair.nearest = std::numeric_limits<double>::infinity();
  for (const Seen& view : seen) {
    const Eigen::Vector3d center = transform->T_parent_child.inverse() * view.T_camera_board.t;
    pair.nearest = std::min(pair.nearest, center.norm());
    pair.farthest = std::max(pair.farthest, center.norm());
    pair.ids.push_back(view.id);
    pair.information.push_back(view_information(model, view.T_camera_board));
  }
  return pair;
}

std::vector<int> best_views(const Rig& rig, const Calibration& calibration,
                            const std::vector<ViewSights>& views, std::size_t count,
                            const SigmaTarget& target) {
  const std::optional<PairModel> pair = worst_pair_model(rig, calibration, views, {}, target);
  if (!pair) return {};
  std::vector<int> ids;
  for (const std::size_t i : choose_views(pair->information, count, pair->prior, target)) {
    ids.push_back(pair->ids[i]);
  }
  return ids;
}

}  // namespace ca2
