// The fits from every starting shape, the gates, and what is said of the best.
#include "core/intrinsics/estimate_intrinsics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/intrinsics/intrinsics_fit.h"
#include "core/intrinsics/intrinsics_gates.h"
#include "core/types/counted.h"

namespace ca2 {
namespace {

Error too_few_views(const IntrinsicsFit& fit, const IntrinsicsGates& gates) {
  std::vector<Problem> problems{{"",
                                 std::to_string(fit.used_views()) + " of " +
                                     counted(fit.views.size(), "view") + " can be used, " +
                                     std::to_string(gates.min_views) + " are needed",
                                 "show the board in more places, tilted differently each time"}};
  for (std::size_t i = 0; i < fit.views.size(); ++i) {
    if (!fit.views[i].used) problems.push_back({"view " + std::to_string(i + 1), fit.reasons[i], ""});
  }
  return {ErrorCode::refused, std::move(problems)};
}

/// Seeds and settles; the reason when that does not end in a camera.
std::optional<Error> solve(IntrinsicsFit& fit, const CameraParameters& shape, const IntrinsicsGates& gates) {
  if (!fit.seed(shape)) {
    return Error(ErrorCode::refused, "", "no focal length lets the board fit its corners",
                 "check the board's columns, rows and square, and the camera model");
  }
  if (fit.used_views() < gates.min_views) return too_few_views(fit, gates);
  // Before and after: parallel boards may send the focal length anywhere.
  if (auto problem = tilt_problem(gates, fit.poses()))
    return Error(ErrorCode::refused, std::vector{*problem});
  const bool settled = fit.settle(gates.min_views);
  if (fit.used_views() < gates.min_views) return too_few_views(fit, gates);
  if (auto problem = tilt_problem(gates, fit.poses()))
    return Error(ErrorCode::refused, std::vector{*problem});
  if (!settled) {
    return Error(ErrorCode::refused, "", "the camera does not settle: these views leave its parameters open",
                 "show the board in more places and tilted to every side, or estimate a simpler model");
  }
  return std::nullopt;
}

/// Inverse of the parameters' information, scaled to a unit diagonal before it is judged and inverted.
std::optional<Eigen::MatrixXd> inverse_information(const IntrinsicsFit& fit) {
  IntrinsicsBundle bundle(fit.views, IntrinsicsFit::huber_sigmas * fit.noise);
  bundle.linearize(fit.state);
  const auto information = bundle.information();
  if (!information || !(information->diagonal().minCoeff() > 0)) return std::nullopt;
  const Eigen::VectorXd scale = information->diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * *information * scale.asDiagonal());
  if (llt.info() != Eigen::Success || !(llt.rcond() > 1e-14)) return std::nullopt;
  const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(scale.size(), scale.size()));
  return Eigen::MatrixXd(scale.asDiagonal() * inverse * scale.asDiagonal());
}

Result<IntrinsicsEstimate> finish(const IntrinsicsFit& fit, const IntrinsicsGates& gates) {
  IntrinsicsEstimate estimate;
  estimate.camera = fit.state.camera;
  double whitened = 0, squares = 0, count = 0;
  double unknowns = static_cast<double>(fit.state.camera.parameters.size());
  for (std::size_t i = 0; i < fit.views.size(); ++i) {
    IntrinsicsView view{fit.views[i].used, fit.reasons[i], std::nullopt, 0, 0, 0};
    // A board in the camera's very centre is one that was never placed.
    if (!fit.state.poses[i].t.isZero()) view.T_camera_board = fit.state.poses[i];
    double view_squares = 0;
    for (const BundleCorner& corner : fit.views[i].corners) {
      if (!view.used) break;
      const auto pixel = fit.state.camera.project(fit.state.poses[i] * corner.p_board);
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
    squares += view_squares;
    count += view.corners_used;
    estimate.views.push_back(std::move(view));
  }
  estimate.reprojection_rms = std::sqrt(squares / count);
  estimate.noise_scale = std::sqrt(whitened / (2 * count - unknowns));
  const auto covariance = inverse_information(fit);
  if (!covariance) {
    return fail(ErrorCode::refused, "", "these views leave some of the camera's parameters open",
                "show the board in more places and tilted to every side, or estimate a simpler model");
  }
  estimate.covariance = estimate.noise_scale * estimate.noise_scale * *covariance;
  estimate.projection_sigma = projection_sigma(estimate.camera, estimate.covariance, fit.pixels());
  if (const auto problem = determination_problem(gates, estimate)) {
    return fail(ErrorCode::refused, std::vector{*problem});
  }
  return estimate;
}

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

  const IntrinsicsFit start(board, views, camera);
  if (start.used_views() < gates.min_views) return fail(too_few_views(start, gates));
  if (const auto problem = coverage_problem(gates, width, height, start.pixels())) {
    return fail(ErrorCode::refused, std::vector{*problem});
  }
  std::vector<IntrinsicsFit> fits;
  std::optional<Error> error;
  for (const CameraParameters& shape : camera.model->initial_shapes()) {
    IntrinsicsFit fit = start;
    if (auto reason = solve(fit, shape, gates)) {
      if (!error) error = std::move(reason);
    } else {
      fits.push_back(std::move(fit));
    }
  }
  if (fits.empty()) return fail(*error);
  // Compared over all views at the smaller noise: a fit must not win by setting more aside. A later shape
  // must be better by 3 sigma: the models list the likelier lens first.
  double noise = fits.front().noise;
  for (const IntrinsicsFit& fit : fits) noise = std::min(noise, fit.noise);
  const double limit = IntrinsicsFit::corner_sigmas * noise;
  const IntrinsicsFit* best = &fits.front();
  for (const IntrinsicsFit& fit : fits) {
    if (fit.misfit(limit) + 9 * noise * noise < best->misfit(limit)) best = &fit;
  }
  return finish(*best, gates);
}

}  // namespace ca2
