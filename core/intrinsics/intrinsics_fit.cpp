#include "core/intrinsics/intrinsics_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/levenberg_marquardt.h"

namespace ca2 {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rayleigh_median = 1.17741;  ///< of a 2-vector's length, unit noise
constexpr std::size_t min_corners = 6;       ///< of a view: 4 fix its pose, the rest tells of the camera
constexpr double view_ratio = 4;             ///< a view that is so much worse than the usual one is wrong
constexpr double kept_share = 0.6;           ///< a view that keeps less of its corners is wrong

constexpr std::array<double, 12> fields_of_view{12,  20,  30,  45,  60,  80,  // degrees, across the width
                                                100, 120, 140, 165, 190, 220};

double median(std::vector<double> values) {
  if (values.empty()) return infinity;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Lengths of a view's whitened errors, of all its corners; infinite where one does not project.
std::vector<double> lengths(const IntrinsicsBundle::State& state, std::size_t i,
                            const std::vector<BundleView>& views) {
  std::vector<double> result;
  for (const BundleCorner& corner : views[i].corners) {
    const auto residual = whitened_residual(state.camera, state.poses[i], corner);
    result.push_back(residual ? residual->norm() : infinity);
  }
  return result;
}

double noise_of(const IntrinsicsBundle::State& state, const std::vector<BundleView>& views) {
  std::vector<double> all;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views[i].used) continue;
    const std::vector<double> more = lengths(state, i, views);
    all.insert(all.end(), more.begin(), more.end());
  }
  return std::max(median(std::move(all)) / rayleigh_median, 1e-9);  // noise-free corners: not zero
}

/// One adjustment of the active corners that project at its start.
bool adjust(IntrinsicsBundle::State& state, std::vector<BundleView>& views, int iterations) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (BundleCorner& corner : views[i].corners) {
      if (views[i].used && !whitened_residual(state.camera, state.poses[i], corner)) corner.active = false;
    }
  }
  IntrinsicsBundle bundle(views, IntrinsicsFit::huber_sigmas * noise_of(state, views));
  return minimize(bundle, state, {.max_iterations = iterations}).converged;
}

}  // namespace

IntrinsicsFit::IntrinsicsFit(const Board& board, std::span<const std::vector<Corner>> corners,
                             const Camera& camera)
    : state{camera, std::vector<Pose>(corners.size())}, board_(board), corners_(corners) {
  const std::vector<Eigen::Vector2d> points = board.type->corners(board);
  for (const std::vector<Corner>& list : corners) {
    BundleView view;
    for (const Corner& corner : list) {
      if (corner.id < 0 || static_cast<std::size_t>(corner.id) >= points.size()) continue;
      if (!corner.pixel.allFinite() || !corner.covariance.allFinite()) continue;
      const Eigen::LLT<Eigen::Matrix2d> llt(corner.covariance);
      if (llt.info() != Eigen::Success) continue;
      const Eigen::Vector2d& p = points[static_cast<std::size_t>(corner.id)];
      view.corners.push_back(
          {{p.x(), p.y(), 0}, corner.pixel, llt.matrixL().solve(Eigen::Matrix2d::Identity())});
    }
    view.used = view.corners.size() >= min_corners;
    usable_.push_back(view.used);
    reasons.push_back(view.used ? "" : "fewer than " + std::to_string(min_corners) + " corners");
    views.push_back(std::move(view));
  }
}

/// The focal length that spreads `field_of_view` [rad] over the picture's width.
bool IntrinsicsFit::hypothesis(double field_of_view, const CameraParameters& shape, Camera& camera) const {
  camera.parameters.resize(4 + shape.size());
  camera.parameters << 1, 1, 0, 0, shape;
  const auto rim = camera.project({std::sin(field_of_view / 2), 0, std::cos(field_of_view / 2)});
  if (!rim) return false;
  camera.parameters[0] = camera.parameters[1] = 0.5 * camera.width / rim->x();
  camera.parameters[2] = 0.5 * (camera.width - 1);
  camera.parameters[3] = 0.5 * (camera.height - 1);
  return true;
}

/// Board poses under a camera; views without one are not used. Median error over the views, px.
double IntrinsicsFit::place_boards(IntrinsicsBundle::State& placed, std::vector<BundleView>& of) const {
  std::vector<double> errors;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (!of[i].used) continue;
    const auto pose = estimate_board_pose(board_, placed.camera, corners_[i]);
    errors.push_back(pose ? pose->reprojection_rms : infinity);
    if (pose) placed.poses[i] = pose->T_camera_board;
    of[i].used = pose.has_value();
  }
  return median(std::move(errors));
}

bool IntrinsicsFit::seed(const CameraParameters& shape) {
  struct Candidate {
    double error;
    IntrinsicsBundle::State state;
    std::vector<BundleView> views;
  };
  std::vector<BundleView> few = views;
  const std::size_t stride = std::max<std::size_t>(1, static_cast<std::size_t>(used_views()) / 12);
  std::size_t number = 0;
  for (BundleView& view : few) {
    if (view.used) view.used = number++ % stride == 0;
  }
  std::vector<Candidate> candidates;
  for (const double degrees : fields_of_view) {
    Candidate candidate{0, state, few};
    if (!hypothesis(degrees * M_PI / 180, shape, candidate.state.camera)) continue;
    candidate.error = place_boards(candidate.state, candidate.views);
    if (std::isfinite(candidate.error)) candidates.push_back(std::move(candidate));
  }
  const auto better = [](const Candidate& a, const Candidate& b) { return a.error < b.error; };
  std::stable_sort(candidates.begin(), candidates.end(), better);
  if (candidates.size() > 3) candidates.resize(3);
  for (Candidate& candidate : candidates) {
    // Twice: the corners that Huber's cost holds for outliers change with the first.
    for (int i = 0; i < 2; ++i) adjust(candidate.state, candidate.views, 40);
    candidate.error = noise_of(candidate.state, candidate.views);
  }
  const auto best = std::min_element(candidates.begin(), candidates.end(), better);
  if (best == candidates.end()) return false;
  state = best->state;
  place_boards(state, views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (usable_[i] && !views[i].used) reasons[i] = "no pose of the board fits its corners";
  }
  return true;
}

bool IntrinsicsFit::settle(int min_views) {
  noise = noise_of(state, views);
  // The first two rounds judge nobody: their camera is still being formed.
  for (int round = 0; round < 12; ++round) {
    const bool changed = round >= 2 && classify();
    if (used_views() < min_views) return false;
    const double before = noise;
    const bool converged = adjust(state, views, 200);
    noise = noise_of(state, views);
    if (round >= 2 && !changed && converged && std::abs(noise - before) <= 1e-3 * noise) return true;
  }
  return false;
}

/// Decides afresh which views and corners agree with the present camera; true when something changed.
bool IntrinsicsFit::classify() {
  std::vector<std::vector<double>> errors(views.size());
  std::vector<double> typical;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!usable_[i]) continue;
    if (!views[i].used) {
      const auto pose = estimate_board_pose(board_, state.camera, corners_[i]);
      if (!pose) continue;
      state.poses[i] = pose->T_camera_board;
    }
    errors[i] = lengths(state, i, views);
    typical.push_back(median(errors[i]));
  }
  const double usual = median(typical);
  bool changed = false;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (errors[i].empty()) continue;
    std::size_t kept = 0;
    for (std::size_t j = 0; j < errors[i].size(); ++j) {
      const bool active = errors[i][j] < corner_sigmas * noise;
      kept += active;
      changed = changed || (views[i].used && active != views[i].corners[j].active);
      views[i].corners[j].active = active;
    }
    const std::size_t count = errors[i].size();
    const double own = median(errors[i]);
    reasons[i].clear();
    if (!std::isfinite(own)) {
      reasons[i] = "no pose of the board fits its corners";
    } else if (own > view_ratio * usual) {
      reasons[i] = "its corners miss the board by " + std::to_string(std::lround(own / usual)) +
                   " times more than those of other views";
    } else if (kept < min_corners || static_cast<double>(kept) < kept_share * static_cast<double>(count)) {
      reasons[i] = std::to_string(count - kept) + " of its " + std::to_string(count) +
                   " corners disagree with the other views";
    }
    changed = changed || views[i].used != reasons[i].empty();
    views[i].used = reasons[i].empty();
  }
  return changed;
}

double IntrinsicsFit::misfit(double limit) const {
  double sum = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!usable_[i]) continue;
    for (const double length : lengths(state, i, views)) sum += std::pow(std::min(length, limit), 2);
  }
  return sum;
}

int IntrinsicsFit::used_views() const {
  return static_cast<int>(std::count_if(views.begin(), views.end(), [](const auto& v) { return v.used; }));
}

std::vector<Eigen::Vector2d> IntrinsicsFit::pixels() const {
  std::vector<Eigen::Vector2d> result;
  for (const BundleView& view : views) {
    for (const BundleCorner& corner : view.corners) {
      if (view.used && corner.active) result.push_back(corner.pixel);
    }
  }
  return result;
}

std::vector<Pose> IntrinsicsFit::poses() const {
  std::vector<Pose> result;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].used) result.push_back(state.poses[i]);
  }
  return result;
}

}  // namespace ca2
