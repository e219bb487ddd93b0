#include "core/intrinsics/intrinsics_gates.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace ca2 {
namespace {

constexpr int cells = 6;  ///< along each side: a board in a corner of the picture fills several

std::string with_digits(double value, int digits) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

/// Focal lengths of the picture near the axis, px: what fx and fy are for a pinhole, also for models whose fx
/// means something else.
Eigen::Vector2d axis_focal(const Camera& camera) {
  ProjectionJacobian jacobian;
  if (!camera.project({0, 0, 1}, &jacobian)) return Eigen::Vector2d::Zero();
  return {jacobian.point(0, 0), jacobian.point(1, 1)};
}

/// Relative standard deviation of the worse of the two.
double axis_focal_sigma(const Camera& camera, const Eigen::MatrixXd& covariance) {
  const Eigen::Vector2d focal = axis_focal(camera);
  Eigen::MatrixXd derivative(2, camera.parameters.size());
  for (Eigen::Index i = 0; i < camera.parameters.size(); ++i) {
    Camera plus = camera, minus = camera;
    const double h = 1e-6 * std::max(1.0, std::abs(camera.parameters[i]));
    plus.parameters[i] += h;
    minus.parameters[i] -= h;
    derivative.col(i) = (axis_focal(plus) - axis_focal(minus)) / (2 * h);
  }
  const Eigen::Matrix2d of_focal = derivative * covariance * derivative.transpose();
  return of_focal.diagonal().cwiseSqrt().cwiseQuotient(focal).maxCoeff();
}

}  // namespace

std::optional<Problem> coverage_problem(const IntrinsicsGates& gates, int width, int height,
                                        std::span<const Eigen::Vector2d> corners) {
  std::array<std::array<bool, cells>, cells> seen{};
  for (const Eigen::Vector2d& pixel : corners) {
    const double x = (pixel.x() + 0.5) / width * cells, y = (pixel.y() + 0.5) / height * cells;
    if (!(x >= 0 && y >= 0 && x < cells && y < cells)) continue;
    seen[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = true;
  }
  int count = 0;
  std::array<int, 4> sides{};  // cells seen in the left, right, upper, lower third
  for (std::size_t y = 0; y < cells; ++y) {
    for (std::size_t x = 0; x < cells; ++x) {
      if (!seen[y][x]) continue;
      ++count;
      sides[0] += x < cells / 3;
      sides[1] += x >= cells - cells / 3;
      sides[2] += y < cells / 3;
      sides[3] += y >= cells - cells / 3;
    }
  }
  const double coverage = static_cast<double>(count) / (cells * cells);
  if (coverage >= gates.min_coverage) return std::nullopt;
  static constexpr std::array<const char*, 4> names{"left", "right", "top", "bottom"};
  std::string where;
  for (std::size_t i = 0; i < 4; ++i) {
    // Less than half as well seen as the gate asks of the whole.
    if (sides[i] < 0.5 * gates.min_coverage * (cells / 3) * cells) {
      where += (where.empty() ? "" : ", ") + std::string(names[i]);
    }
  }
  return Problem{"",
                 "the corners reach only " + with_digits(100 * coverage, 0) + " % of the picture, " +
                     with_digits(100 * gates.min_coverage, 0) + " % are needed",
                 where.empty() ? "show the board closer, or in more places of the picture"
                               : "show the board at the picture's " + where};
}

std::optional<Problem> tilt_problem(const IntrinsicsGates& gates, std::span<const Pose> poses) {
  double widest = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d a = poses[i].R.col(2), b = poses[j].R.col(2);
      widest = std::max(widest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }
  if (widest >= gates.min_tilt) return std::nullopt;
  return Problem{
      "",
      "all boards face the same way to within " + with_digits(widest * 180 / M_PI, 1) +
          " degrees, which leaves the focal length open",
      "tilt the board by 30 to 45 degrees: left edge nearer, right edge nearer, top and bottom too"};
}

std::optional<Problem> determination_problem(const IntrinsicsGates& gates,
                                             const IntrinsicsEstimate& estimate) {
  const Camera& camera = estimate.camera;
  const double focal = axis_focal_sigma(camera, estimate.covariance);
  if (!(focal <= gates.max_focal_sigma)) {
    return Problem{"", "the focal length is only known to " + with_digits(100 * focal, 1) + " % (sigma)",
                   "show the board larger and tilted by 30 to 45 degrees to every side"};
  }
  for (int i = 2; i < 4; ++i) {
    const double sigma = std::sqrt(estimate.covariance(i, i));
    if (!(sigma <= gates.max_center_sigma * camera.width)) {
      return Problem{"",
                     std::string("the principal point's ") + (i == 2 ? "x" : "y") + " is only known to " +
                         with_digits(sigma, 1) + " px (sigma)",
                     i == 2
                         ? "tilt the board about its upright axis: left edge nearer, then right edge nearer"
                         : "tilt the board about its level axis: top edge nearer, then bottom edge nearer"};
    }
  }
  if (!(estimate.projection_sigma <= gates.max_projection_sigma)) {
    return Problem{"",
                   "the distortion is only known to " + with_digits(estimate.projection_sigma, 1) +
                       " px where the corners were (sigma)",
                   "show the board in more places, to the rim of the picture"};
  }
  return std::nullopt;
}

double projection_sigma(const Camera& camera, const Eigen::MatrixXd& covariance,
                        std::span<const Eigen::Vector2d> corners) {
  const Eigen::Index n = camera.parameters.size();
  Eigen::MatrixXd by_parameters = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(n, 3);
  Eigen::Matrix3d by_rotation = Eigen::Matrix3d::Zero();
  int count = 0;
  const std::size_t stride = std::max<std::size_t>(1, corners.size() / 500);
  for (std::size_t i = 0; i < corners.size(); i += stride) {
    const auto ray = camera.unproject(corners[i]);
    ProjectionJacobian jacobian;
    if (!ray || !camera.project(*ray, &jacobian)) continue;
    const Eigen::Matrix<double, 2, 3> rotation = -jacobian.point * skew(*ray);
    by_parameters += jacobian.parameters.transpose() * jacobian.parameters;
    mixed += jacobian.parameters.transpose() * rotation;
    by_rotation += rotation.transpose() * rotation;
    ++count;
  }
  if (count == 0) return HUGE_VAL;
  // trace of (I - P) J C J^T with P the projection onto the rotations' effects.
  const Eigen::MatrixXd rest = by_parameters - mixed * by_rotation.ldlt().solve(mixed.transpose());
  return std::sqrt(std::max(0.0, (covariance * rest).trace()) / count);
}

}  // namespace ca2
