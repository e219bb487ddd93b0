#include "core/guidance/next_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/guidance/candidate_poses.h"
#include "core/guidance/pair_model.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double usual_distance = 3.5;  // of the board's width: an A3 board at 1.5 m

constexpr double vague_bias = 0.02;  // m

/// A LiDAR of few rings that looks where the camera looks, and sits there: about right for most rigs.
SightModel assumed_model(const Board& board, const Camera& camera) {
  SightModel model;
  model.board = board;
  model.camera = camera;
  model.T_camera_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  model.T_camera_lidar.t.setZero();
  model.returns_per_steradian = 5000;
  model.lowest = -15 * M_PI / 180;
  model.highest = 15 * M_PI / 180;
  return model;
}

/// Enough that the sums are finite: half a radian, a metre.
Eigen::Matrix<double, 6, 6> vague_place() {
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
  information.topLeftCorner<3, 3>() *= 4;
  return information;
}

int rounded_degrees(double angle) {
  return 5 * static_cast<int>(std::lround(angle * 180 / M_PI / 5));
}

/// The model says by how much the pose helps; how good the answer is now, the solver knows better. One or
/// two views determine the answer by rims alone, which the model does not have: there it says what planes
/// will give.
double expected_after(double sigma, double modelled_now, double modelled_after) {
  constexpr double undetermined = 1;  // m, rad
  return modelled_now < undetermined ? sigma * modelled_after / modelled_now
                                     : std::min(sigma, modelled_after);
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
  const std::optional<PairModel> pair = worst_pair_model(rig, calibration, views, lidars, target);
  if (!pair) return std::nullopt;
  PairInformation known = pair->prior;
  for (const PairInformation& view : pair->information) known += view;
  const ExpectedSigma now = expected_sigma(known, target);
  const Pose* best = nullptr;
  ExpectedSigma after;
  after.cost = std::numeric_limits<double>::infinity();
  const std::vector<Pose> candidates = candidate_poses(rig.board, pair->model.camera);
  for (const Pose& pose : candidates) {
    // LiDARs are blind close by, and far away too few returns meet the board; where, only the views tell.
    const double distance = (pair->transform.T_parent_child.inverse() * pose.t).norm();
    if (distance < 0.7 * pair->nearest || distance > 1.4 * pair->farthest) continue;
    const ExpectedSigma here = expected_sigma(known + view_information(pair->model, pose), target);
    if (here.cost < after.cost) best = &pose, after = here;
  }
  if (best == nullptr) return std::nullopt;
  NextPose next;
  next.words = pose_in_words(*best);
  next.camera = pair->transform.parent;
  next.T_camera_board = *best;
  next.sigma_translation =
      expected_after(pair->transform.sigma_translation(), now.translation, after.translation);
  next.sigma_rotation = expected_after(pair->transform.sigma_rotation(), now.rotation, after.rotation);
  return next;
}

std::optional<NextPose> suggest_first_pose(const Rig& rig, const std::vector<ViewSights>& views) {
  for (const auto& [name, camera] : rig.cameras) {
    if (!camera.intrinsics) continue;
    const auto c = static_cast<std::size_t>(std::distance(rig.cameras.begin(), rig.cameras.find(name)));
    const SightModel model = assumed_model(rig.board, *camera.intrinsics);
    PairInformation known = bias_prior(vague_bias);
    known.topLeftCorner<6, 6>() += vague_place();
    for (const ViewSights& view : views) {
      if (view.cameras[c]) known += view_information(model, view.cameras[c]->pose.T_camera_board);
    }
    const double usual = usual_distance * std::max(rig.board.extent().width, rig.board.extent().height);
    const Pose* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    const std::vector<Pose> candidates = candidate_poses(rig.board, *camera.intrinsics);
    for (const Pose& pose : candidates) {
      // Near by, a LiDAR is blind or looks past; far away few of its rings meet the board.
      if (std::abs(std::log(pose.t.norm() / usual)) > 0.5) continue;
      const double cost = expected_sigma(known + view_information(model, pose), {}).cost;
      if (cost < least) best = &pose, least = cost;
    }
    if (best == nullptr) continue;
    return NextPose{pose_in_words(*best), name, *best, std::numeric_limits<double>::infinity(),
                    std::numeric_limits<double>::infinity()};
  }
  return std::nullopt;
}

}  // namespace ca2
