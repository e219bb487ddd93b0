#include "core/report/evidence.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/lidar/ray_plane.h"
#include "core/solve/calibrate.h"

namespace ca2 {
namespace {

const Pose* find_transform(const Calibration& calibration, const std::string& parent,
                           const std::string& child) {
  for (const CalibratedTransform& t : calibration.transforms) {
    if (t.parent == parent && t.child == child) return &t.T_parent_child;
  }
  return nullptr;
}

/// `places`: of the corners on the board, by id.
std::vector<CornerError> corner_errors(const std::vector<Eigen::Vector2d>& places, const Camera& camera,
                                       const Pose& T_camera_board, const std::vector<Corner>& corners) {
  std::vector<CornerError> errors;
  for (const Corner& corner : corners) {
    const Eigen::Vector2d& at = places[static_cast<std::size_t>(corner.id)];
    const auto pixel = camera.project(T_camera_board * Eigen::Vector3d(at.x(), at.y(), 0));
    if (pixel) errors.push_back({corner.id, corner.pixel, corner.pixel - *pixel});
  }
  return errors;
}

/// The hypothesis that is the board: the one where the camera says the plate is; nothing where none is near.
const LidarSight* chosen(const std::vector<LidarSight>& sights, const Eigen::Vector3d& centre, double reach) {
  const LidarSight* best = nullptr;
  double nearest = reach;
  for (const LidarSight& sight : sights) {
    const double distance = (sight.center - centre).norm();
    if (distance < nearest) best = &sight, nearest = distance;
  }
  return best;
}

std::vector<BoardPointError> point_errors(const LidarSight& sight, const Pose& T_lidar_board, double bias) {
  const Plane plane = board_plane(T_lidar_board);
  std::vector<BoardPointError> errors;
  for (const BoardReturn& r : sight.on_board) {
    const Eigen::Vector3d p = r.point.cast<double>();
    const double error = range_residual(plane, p) - bias;
    if (std::isfinite(error)) errors.push_back({p, error});
  }
  return errors;
}

ViewEvidence evidence_of(const Extraction& features, const Calibration& calibration, const ViewSights& view) {
  ViewEvidence evidence;
  evidence.id = view.id;
  const Board& board = features.rig.board;
  const Outline extent = board.extent();
  const Eigen::Vector2d& stretch = calibration.print.stretch;
  const std::vector<Eigen::Vector2d> places = printed_corners(board, stretch);
  std::size_t c = 0;
  for (const auto& [camera, rig_camera] : features.rig.cameras) {
    const std::optional<CameraSight>& sight = view.cameras[c++];
    const auto model = calibration.cameras.find(camera);
    if (!sight || model == calibration.cameras.end()) continue;
    const Result<BoardPose> pose = estimate_board_pose(board, model->second.camera, sight->corners, stretch);
    if (!pose) continue;
    evidence.T_camera_board[camera] = pose->T_camera_board;
    evidence.corners[camera] =
        corner_errors(places, model->second.camera, pose->T_camera_board, sight->corners);
    std::size_t l = 0;
    for (const auto& [lidar, rig_lidar] : features.rig.lidars) {
      const std::vector<LidarSight>& sights = view.lidars[l++];
      const Pose* T_camera_lidar = find_transform(calibration, camera, lidar);
      if (!T_camera_lidar) continue;
      const Pose T_lidar_board = T_camera_lidar->inverse() * pose->T_camera_board;
      const Eigen::Vector3d centre = T_lidar_board * Eigen::Vector3d(extent.center.x(), extent.center.y(), 0);
      const LidarSight* on_board = chosen(sights, centre, 0.5 * std::hypot(extent.width, extent.height));
      const auto noise = calibration.lidars.find(lidar);
      const double bias = noise == calibration.lidars.end() ? 0 : noise->second.range_bias;
      if (on_board) evidence.points[{camera, lidar}] = point_errors(*on_board, T_lidar_board, bias);
    }
  }
  return evidence;
}

std::vector<StereoEvidence> stereo_of(const Evidence& evidence, const Extraction& features,
                                      const Calibration& calibration) {
  std::vector<StereoEvidence> pairs;
  const std::vector<Eigen::Vector2d> places = printed_corners(features.rig.board, calibration.print.stretch);
  for (const CalibratedTransform& t : calibration.transforms) {
    const auto b = calibration.cameras.find(t.parent), a = calibration.cameras.find(t.child);
    if (a == calibration.cameras.end() || b == calibration.cameras.end()) continue;
    StereoEvidence pair{t.child, t.parent, 0, 0, Eigen::Vector3d::Zero()};
    double squares = 0;
    int count = 0;
    for (const ViewEvidence& view : evidence.views) {
      const auto in_a = view.T_camera_board.find(t.child), in_b = view.T_camera_board.find(t.parent);
      if (in_a == view.T_camera_board.end() || in_b == view.T_camera_board.end()) continue;
      const Pose T_b_board = t.T_parent_child * in_a->second;
      pair.offset += in_b->second.t - T_b_board.t;
      ++pair.views;
      for (const CornerError& seen : view.corners.at(t.parent)) {
        const Eigen::Vector2d& place = places[static_cast<std::size_t>(seen.id)];
        const auto pixel = b->second.camera.project(T_b_board * Eigen::Vector3d(place.x(), place.y(), 0));
        if (pixel) squares += (seen.pixel - *pixel).squaredNorm(), ++count;
      }
    }
    if (pair.views == 0 || count == 0) continue;
    pair.offset /= pair.views;
    pair.rms = std::sqrt(squares / count);
    pairs.push_back(pair);
  }
  return pairs;
}

/// Ten steps at most: 3, 4, 5 ... and then ever wider.
std::vector<std::size_t> step_sizes(std::size_t views) {
  std::set<std::size_t> sizes;
  for (double size = 3; size < static_cast<double>(views);
       size *= std::max(1.15, std::pow(static_cast<double>(views) / 3, 0.1))) {
    sizes.insert(static_cast<std::size_t>(size));
  }
  if (views >= 3) sizes.insert(views);
  return {sizes.begin(), sizes.end()};
}

void settle(Evidence& evidence, const Extraction& features, const Calibration& calibration) {
  std::vector<ViewSights> used;
  for (const ViewSights& view : features.views) {
    for (const CalibratedView& outcome : calibration.views) {
      if (outcome.id == view.id && outcome.used) used.push_back(view);
    }
  }
  CalibrateOptions options;
  options.estimated = features.estimated;
  options.method = calibration.method == "kim"              ? Method::kim
                   : calibration.method == "plane_to_plane" ? Method::plane_to_plane
                                                            : Method::joint;
  for (const std::size_t count : step_sizes(used.size())) {
    const std::vector<ViewSights> first(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(count));
    const Result<Calibration> answer = calibrate(features.rig, first, options);
    if (!answer) continue;  // refused: these views do not determine it
    for (const CalibratedTransform& t : answer->transforms) {
      const Pose* final = find_transform(calibration, t.parent, t.child);
      if (!final || calibration.cameras.count(t.child)) continue;
      const Vector6d change = final->difference(t.T_parent_child);
      evidence.settling[t.parent + " " + t.child].push_back({static_cast<int>(count), t.sigma_translation(),
                                                             t.sigma_rotation(), change.tail<3>().norm(),
                                                             change.head<3>().norm()});
    }
  }
}

}  // namespace

Evidence gather_evidence(const Extraction& features, const Calibration& calibration) {
  Evidence evidence;
  for (const ViewSights& view : features.views) {
    for (const CalibratedView& outcome : calibration.views) {
      if (outcome.id == view.id && outcome.used)
        evidence.views.push_back(evidence_of(features, calibration, view));
    }
  }
  evidence.stereo = stereo_of(evidence, features, calibration);
  settle(evidence, features, calibration);
  return evidence;
}

}  // namespace ca2
