#include "core/camera/distortion_doubt.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double degrees = 180 / M_PI;
constexpr double nearly_all = 80 / degrees;  // off the axis: a fisheye's picture may end there
constexpr double stretched = 1.5;            // strong pincushions have 1.2

Eigen::Vector3d direction(double angle) {
  return {std::sin(angle), 0, std::cos(angle)};
}

/// Off the axis: up to there the model has pixels.
double last_angle(const CameraModel& model, const CameraParameters& parameters) {
  double low = 0, high = M_PI;
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = 0.5 * (low + high);
    (model.project(parameters, direction(middle)) ? low : high) = middle;
  }
  return low;
}

CameraParameters without(const CameraParameters& parameters, Eigen::Index coefficient) {
  CameraParameters changed = parameters;
  changed[coefficient] = 0;
  return changed;
}

/// " (k1 = -3)": of the coefficient without which `badness` is least.
template <class Badness>
std::string culprit(const CameraModel& model, const CameraParameters& parameters, Badness badness) {
  Eigen::Index worst = 0;
  double least = badness(parameters);
  for (Eigen::Index i = 4; i < parameters.size(); ++i) {
    const double now = badness(without(parameters, i));
    if (now < least) least = now, worst = i;
  }
  if (worst == 0) return {};
  const std::string_view name = model.parameter_names()[static_cast<std::size_t>(worst)];
  return formatted(" (%.*s = %g)", static_cast<int>(name.size()), name.data(), parameters[worst]);
}

/// How much farther from the principal point it is drawn than where the coefficients are 0.
double stretch_at(const Camera& camera, const CameraParameters& parameters, double angle) {
  CameraParameters plain = parameters;
  plain.tail(plain.size() - 4).setZero();
  const auto distorted = camera.model->project(parameters, direction(angle));
  const auto undistorted = camera.model->project(plain, direction(angle));
  if (!distorted || !undistorted || angle <= 0) return 1;
  const Eigen::Vector2d center = parameters.segment<2>(2);
  return (*distorted - center).norm() / (*undistorted - center).norm();
}

}  // namespace

std::optional<std::string> distortion_doubt(const Camera& camera) {
  const CameraModel& model = *camera.model;
  const CameraParameters& p = camera.parameters;
  const double width = camera.width > 0 ? camera.width : 2 * p[2];
  const double height = camera.height > 0 ? camera.height : 2 * p[3];
  if (!(p[2] > 0 && p[2] < width && p[3] > 0 && p[3] < height)) return std::nullopt;
  const std::array<Eigen::Vector2d, 4> sides{Eigen::Vector2d(0, p[3]), Eigen::Vector2d(width - 1, p[3]),
                                             Eigen::Vector2d(p[2], 0), Eigen::Vector2d(p[2], height - 1)};
  double widest = 0;  // rad
  bool whole = true;
  for (const Eigen::Vector2d& side : sides) {
    const auto seen = model.unproject(p, side);
    if (seen) widest = std::max(widest, std::acos(std::clamp(seen->z(), -1.0, 1.0)));
    whole = whole && seen;
  }
  if (!whole) {
    const double end = last_angle(model, p);
    if (end >= nearly_all) return std::nullopt;
    const auto last = model.project(p, direction(end));
    const double radius = last ? (*last - p.segment<2>(2)).norm() : 0;
    const auto badness = [&](const CameraParameters& other) { return -last_angle(model, other); };
    return formatted(
               "the distortion folds back %.2g degrees off the axis, %.0f px from the principal point, "
               "inside the picture",
               end * degrees, radius) +
           culprit(model, p, badness);
  }
  const double stretch = stretch_at(camera, p, widest);
  if (stretch < stretched) return std::nullopt;
  const auto badness = [&](const CameraParameters& other) { return stretch_at(camera, other, widest); };
  return formatted(
             "the distortion draws what is %.2g degrees off the axis %.2g times as far from the middle as "
             "without it",
             widest * degrees, stretch) +
         culprit(model, p, badness);
}

}  // namespace ca2
