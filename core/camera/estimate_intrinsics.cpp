// From nothing to a camera: focal hypotheses, the best few by short adjustments, then robust rounds of the
// whole adjustment in which views and corners that disagree are set aside, and the gates.
#include "core/camera/estimate_intrinsics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/camera/intrinsics_bundle.h"
#include "core/camera/intrinsics_gates.h"
#include "core/solve/levenberg_marquardt.h"

namespace ca2 {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rayleigh_median = 1.17741;  ///< of a 2-vector's length, unit noise
constexpr std::size_t min_corners = 6;       ///< of a view: 4 fix its pose, the rest tells of the camera
constexpr double huber_sigmas = 3;
constexpr double corner_sigmas = 5;     ///< a good corner is so far off once in 250 000
constexpr double view_ratio = 4;        ///< a view that is so much worse than the usual one is wrong
constexpr double rejected_share = 0.4;  ///< a view that loses so many of its corners is wrong

double median(std::vector<double> values) {
  if (values.empty()) return infinity;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Estimator {
 public:
  Estimator(const Board& board, std::span<const std::vector<Corner>> views, Camera empty,
            const IntrinsicsGates& gates)
      : board_(board), corners_(views), gates_(gates), state_{std::move(empty), {}} {
    const std::vector<Eigen::Vector2d> points = board.type->corners(board);
    for (const std::vector<Corner>& corners : views) {
      BundleView view;
      for (const Corner& corner : corners) {
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
      reasons_.push_back(view.used ? "" : "fewer than " + std::to_string(min_corners) + " corners");
      views_.push_back(std::move(view));
    }
    state_.poses.resize(views_.size());
  }

  Result<IntrinsicsEstimate> run() {
    if (auto error = refuse_few_views()) return fail(*error);
    if (const auto problem = coverage_problem(gates_, state_.camera.width, state_.camera.height, pixels())) {
      return fail(ErrorCode::refused, std::vector{*problem});
    }
    if (!seed()) {
      return fail(
          ErrorCode::refused, "",
          "no focal length lets the board fit its corners in " + std::to_string(gates_.min_views) + " views",
          "check the board's columns, rows and square, and the camera model");
    }
    if (auto error = refuse_flat_tilt()) return fail(*error);
    for (int round = 0; round < 10; ++round) {
      const bool changed = round > 1 && classify();
      if (auto error = refuse_few_views()) return fail(*error);
      const double before = scale_;
      adjust(state_, views_, 200);
      scale_ = noise(state_, views_);
      if (round > 1 && !changed && std::abs(scale_ - before) < 1e-3 * scale_) break;
    }
    if (auto error = refuse_flat_tilt()) return fail(*error);
    return finish();
  }

 private:
  std::optional<Error> refuse_few_views() const {
    const auto used = std::count_if(views_.begin(), views_.end(), [](const auto& v) { return v.used; });
    if (used >= gates_.min_views) return std::nullopt;
    std::vector<Problem> problems{{"",
                                   std::to_string(used) + " of " + std::to_string(views_.size()) +
                                       " views can be used, " + std::to_string(gates_.min_views) +
                                       " are needed",
                                   "show the board in more places, tilted differently each time"}};
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (!views_[i].used) problems.push_back({"view " + std::to_string(i + 1), reasons_[i], ""});
    }
    return Error(ErrorCode::refused, std::move(problems));
  }

  std::optional<Error> refuse_flat_tilt() const {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (views_[i].used) poses.push_back(state_.poses[i]);
    }
    if (const auto problem = tilt_problem(gates_, poses)) {
      return Error(ErrorCode::refused, std::vector{*problem});
    }
    return std::nullopt;
  }

  /// Corners that take part, px.
  std::vector<Eigen::Vector2d> pixels() const {
    std::vector<Eigen::Vector2d> pixels;
    for (const BundleView& view : views_) {
      for (const BundleCorner& corner : view.corners) {
        if (view.used && corner.active) pixels.push_back(corner.pixel);
      }
    }
    return pixels;
  }

  /// Lengths of a view's whitened errors, of all its corners; infinite where one does not project.
  static std::vector<double> lengths(const IntrinsicsBundle::State& state, std::size_t i,
                                     const std::vector<BundleView>& views) {
    std::vector<double> result;
    for (const BundleCorner& corner : views[i].corners) {
      const auto residual = whitened_residual(state.camera, state.poses[i], corner);
      result.push_back(residual ? residual->norm() : infinity);
    }
    return result;
  }

  /// Noise of the corners relative to their covariances, blind to outliers.
  static double noise(const IntrinsicsBundle::State& state, const std::vector<BundleView>& views) {
    std::vector<double> all;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!views[i].used) continue;
      const std::vector<double> more = lengths(state, i, views);
      all.insert(all.end(), more.begin(), more.end());
    }
    return std::max(median(std::move(all)) / rayleigh_median,
                    1e-9);  // noise-free corners must not divide by 0
  }

  /// One adjustment of the views' active corners that project at its start.
  void adjust(IntrinsicsBundle::State& state, std::vector<BundleView>& views, int iterations) const {
    for (std::size_t i = 0; i < views.size(); ++i) {
      for (BundleCorner& corner : views[i].corners) {
        if (views[i].used && !whitened_residual(state.camera, state.poses[i], corner)) corner.active = false;
      }
    }
    IntrinsicsBundle bundle(views, huber_sigmas * noise(state, views));
    minimize(bundle, state, {.max_iterations = iterations});
  }

  /// Board poses under a camera; views without one are not used. Median error over the views, px.
  double place_boards(IntrinsicsBundle::State& state, std::vector<BundleView>& views) const {
    std::vector<double> errors;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!views[i].used) continue;
      const auto pose = estimate_board_pose(board_, state.camera, corners_[i]);
      errors.push_back(pose ? pose->reprojection_rms : infinity);
      if (pose) state.poses[i] = pose->T_camera_board;
      views[i].used = pose.has_value();
    }
    return median(std::move(errors));
  }

  /// The model's starting shape with the focal length that spreads `field_of_view` [rad] over the width.
  bool hypothesis(double field_of_view, Camera& camera) const {
    const CameraParameters shape = camera.model->initial_shape();
    camera.parameters.resize(4 + shape.size());
    camera.parameters << 1, 1, 0, 0, shape;
    const auto rim = camera.project({std::sin(field_of_view / 2), 0, std::cos(field_of_view / 2)});
    if (!rim) return false;
    camera.parameters[0] = camera.parameters[1] = 0.5 * camera.width / rim->x();
    camera.parameters[2] = 0.5 * (camera.width - 1);
    camera.parameters[3] = 0.5 * (camera.height - 1);
    return true;
  }

  /// Tries fields of view from tele lens to fisheye on a dozen views: how well single boards fit sorts them,
  /// a short adjustment of the best three decides.
  bool seed() {
    std::vector<BundleView> few = views_;
    const auto usable = static_cast<std::size_t>(std::count(usable_.begin(), usable_.end(), true));
    const std::size_t stride = std::max<std::size_t>(1, usable / 12);
    std::size_t number = 0;
    for (BundleView& view : few) {
      if (view.used) view.used = number++ % stride == 0;
    }
    struct Candidate {
      double error;
      IntrinsicsBundle::State state;
      std::vector<BundleView> views;
    };
    std::vector<Candidate> candidates;
    for (const double degrees :
         {12.0, 20.0, 30.0, 45.0, 60.0, 80.0, 100.0, 120.0, 140.0, 165.0, 190.0, 220.0}) {
      Candidate candidate{0, state_, few};
      if (!hypothesis(degrees * M_PI / 180, candidate.state.camera)) continue;
      candidate.error = place_boards(candidate.state, candidate.views);
      if (std::isfinite(candidate.error)) candidates.push_back(std::move(candidate));
    }
    const auto better = [](const Candidate& a, const Candidate& b) { return a.error < b.error; };
    std::stable_sort(candidates.begin(), candidates.end(), better);
    if (candidates.size() > 3) candidates.resize(3);
    for (Candidate& candidate : candidates) {
      // Twice: the corners that Huber's cost holds for outliers change with the first.
      for (int i = 0; i < 2; ++i) adjust(candidate.state, candidate.views, 40);
      candidate.error = noise(candidate.state, candidate.views);
    }
    const auto best = std::min_element(candidates.begin(), candidates.end(), better);
    if (best == candidates.end()) return false;
    state_ = best->state;
    place_boards(state_, views_);
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (usable_[i] && !views_[i].used) reasons_[i] = "no pose of the board fits its corners";
    }
    scale_ = noise(state_, views_);
    const auto placed = std::count_if(views_.begin(), views_.end(), [](const auto& v) { return v.used; });
    return placed >= gates_.min_views;
  }

  /// Decides afresh which views and corners agree with the present camera; true when something changed.
  bool classify() {
    std::vector<std::vector<double>> errors(views_.size());
    std::vector<double> typical;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (!usable_[i]) continue;
      if (!views_[i].used) {
        const auto pose = estimate_board_pose(board_, state_.camera, corners_[i]);
        reasons_[i] = "no pose of the board fits its corners";
        if (!pose) continue;
        state_.poses[i] = pose->T_camera_board;
      }
      errors[i] = lengths(state_, i, views_);
      typical.push_back(median(errors[i]));
    }
    const double usual = median(typical);
    bool changed = false;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (errors[i].empty()) continue;
      std::size_t kept = 0;
      for (std::size_t j = 0; j < errors[i].size(); ++j) {
        const bool active = errors[i][j] < corner_sigmas * scale_;
        kept += active;
        changed = changed || (active != views_[i].corners[j].active && views_[i].used);
        views_[i].corners[j].active = active;
      }
      const auto count = static_cast<double>(errors[i].size());
      reasons_[i].clear();
      if (median(errors[i]) > view_ratio * usual) {
        reasons_[i] = "its corners miss the board by " +
                      std::to_string(std::lround(median(errors[i]) / usual)) +
                      " times more than those of other views";
      } else if (kept < min_corners || static_cast<double>(kept) < (1 - rejected_share) * count) {
        reasons_[i] = std::to_string(errors[i].size() - kept) + " of its " +
                      std::to_string(errors[i].size()) + " corners disagree with the other views";
      }
      changed = changed || views_[i].used != reasons_[i].empty();
      views_[i].used = reasons_[i].empty();
    }
    return changed;
  }

  /// Covariance, figures, and the gates on them.
  Result<IntrinsicsEstimate> finish() {
    IntrinsicsEstimate estimate;
    estimate.camera = state_.camera;
    double whitened = 0, squares = 0, count = 0,
           unknowns = static_cast<double>(state_.camera.parameters.size());
    for (std::size_t i = 0; i < views_.size(); ++i) {
      IntrinsicsView view{views_[i].used, reasons_[i], std::nullopt, 0, 0, 0};
      double view_squares = 0;
      for (const BundleCorner& corner : views_[i].corners) {
        if (!views_[i].used) break;
        const auto pixel = state_.camera.project(state_.poses[i] * corner.p_board);
        if (!corner.active || !pixel) {
          ++view.corners_rejected;
          continue;
        }
        ++view.corners_used;
        view_squares += (*pixel - corner.pixel).squaredNorm();
        whitened += (corner.whitener * (*pixel - corner.pixel)).squaredNorm();
      }
      if (view.used) {
        view.reprojection_rms = std::sqrt(view_squares / view.corners_used);
        unknowns += 6;
      }
      if (!state_.poses[i].t.isZero())  // placed at least once
        view.T_camera_board = state_.poses[i];
      squares += view_squares;
      count += view.corners_used;
      estimate.views.push_back(std::move(view));
    }
    estimate.reprojection_rms = std::sqrt(squares / count);
    estimate.noise_scale = std::sqrt(whitened / (2 * count - unknowns));

    IntrinsicsBundle bundle(views_, huber_sigmas * scale_);
    bundle.linearize(state_);
    const auto covariance = covariance_of(bundle);
    if (!covariance) {
      return fail(ErrorCode::refused, "", "these views leave some of the camera's parameters open",
                  "show the board in more places and tilted to every side, or estimate a simpler model");
    }
    estimate.covariance = estimate.noise_scale * estimate.noise_scale * *covariance;
    estimate.projection_sigma = projection_sigma(estimate.camera, estimate.covariance, pixels());
    if (const auto problem = determination_problem(gates_, estimate)) {
      return fail(ErrorCode::refused, std::vector{*problem});
    }
    return estimate;
  }

  /// Inverse of the information, scaled to a unit diagonal before it is judged and inverted.
  static std::optional<Eigen::MatrixXd> covariance_of(const IntrinsicsBundle& bundle) {
    const auto information = bundle.information();
    if (!information || !(information->diagonal().minCoeff() > 0)) return std::nullopt;
    const Eigen::VectorXd scale = information->diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * *information * scale.asDiagonal());
    if (llt.info() != Eigen::Success || llt.rcond() < 1e-14) return std::nullopt;
    const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(scale.size(), scale.size()));
    return Eigen::MatrixXd(scale.asDiagonal() * inverse * scale.asDiagonal());
  }

  const Board& board_;
  std::span<const std::vector<Corner>> corners_;
  const IntrinsicsGates& gates_;
  std::vector<BundleView> views_;
  std::vector<bool> usable_;  ///< has enough corners
  std::vector<std::string> reasons_;
  IntrinsicsBundle::State state_;
  double scale_ = 1;  ///< corners' noise relative to their covariances
};

}  // namespace

Result<IntrinsicsEstimate> estimate_intrinsics(const Board& board, int width, int height,
                                               std::string_view model,
                                               std::span<const std::vector<Corner>> views,
                                               const IntrinsicsGates& gates) {
  Camera camera;
  camera.model = find_camera_model(model);
  camera.width = width;
  camera.height = height;
  if (!camera.model) {
    std::string names;
    for (const CameraModel* known : camera_models()) names += " " + std::string(known->name());
    return fail(ErrorCode::usage, "", "there is no camera model '" + std::string(model) + "'",
                "there are:" + names);
  }
  if (width < 1 || height < 1) return fail(ErrorCode::usage, "", "the picture has no size");
  return Estimator(board, views, camera, gates).run();
}

}  // namespace ca2
