#include "core/lidar/ray_plane.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

/// 1.4826 times the median absolute residual: the standard deviation of normal noise.
double robust_scale(std::vector<double> residuals) {
  for (double& r : residuals) r = std::abs(r);
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return std::max(1.4826 * *middle, 1e-4);
}

double tukey_weight(double x) {
  constexpr double kCut = 4.685;  // 95 % efficiency under normal noise
  const double t = 1 - (x / kCut) * (x / kCut);
  return t > 0 ? t * t : 0;
}

}  // namespace

double range_residual(const Plane& plane, const Eigen::Vector3d& point) {
  const double range = point.norm(), toward = plane.normal.dot(point) / range;
  return range + plane.offset / std::min(toward, -1e-3);
}

RangeFit fit_ranges(std::span<const Eigen::Vector3d> points, const Plane& start) {
  RangeFit fit{start, 0, 0};
  if (points.size() < 3 || start.offset <= 0) return fit;
  std::vector<double> residuals(points.size());
  // The plane as m = n / d: the range along the unit ray f is -1 / (m . f), whose derivative is range^2 f.
  Eigen::Vector3d m = start.normal / start.offset;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const Plane plane{m.normalized(), 1 / m.norm()};
    for (std::size_t i = 0; i < points.size(); ++i) residuals[i] = range_residual(plane, points[i]);
    fit.sigma = robust_scale(residuals);
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double weight = tukey_weight(residuals[i] / fit.sigma);
      if (weight == 0) continue;
      const double range = points[i].norm(), predicted = range - residuals[i];
      const Eigen::Vector3d J = predicted * predicted * (points[i] / range);
      H += weight * J * J.transpose();
      g += weight * residuals[i] * J;
    }
    // Two rings fix the plane only just; a tiny ridge keeps points on a line from throwing it about.
    H.diagonal().array() += 1e-9 * H.trace();
    const Eigen::Vector3d step = H.ldlt().solve(g);
    if (!step.allFinite() || (m + step).norm() < 1e-3) break;
    m += step;
    if (step.norm() < 1e-9 * m.norm()) break;
  }
  fit.plane = {m.normalized(), 1 / m.norm()};
  double sum = 0;
  for (const Eigen::Vector3d& p : points) {
    const double r = range_residual(fit.plane, p);
    sum += r * r;
  }
  fit.rms = std::sqrt(sum / static_cast<double>(points.size()));
  return fit;
}

}  // namespace ca2
