#include "core/lidar/ray_plane.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace ca2 {
namespace {

/// The value that nth_element would find: counted into bins first, as comparing many at random costs a
/// processor more than counting them. `values` are not negative; `scratch` is used up.
double middle_of(const std::vector<double>& values, std::vector<double>& scratch) {
  constexpr std::size_t kBins = 256;
  const double top = *std::max_element(values.begin(), values.end());
  const double scale = top > 0 ? (kBins - 1) / top : 0;
  const auto bin_of = [&](double value) { return static_cast<std::size_t>(value * scale); };
  std::array<std::uint32_t, kBins> counts{};
  for (const double value : values) ++counts[bin_of(value)];
  std::size_t rank = values.size() / 2, bin = 0;
  while (rank >= counts[bin]) rank -= counts[bin++];
  scratch.clear();
  for (const double value : values) {
    if (bin_of(value) == bin) scratch.push_back(value);
  }
  const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(scratch.begin(), middle, scratch.end());
  return *middle;
}

/// 1.4826 times the median absolute residual: the standard deviation of normal
/// noise.
double robust_scale(const std::vector<double>& residuals, std::vector<double>& sizes,
                    std::vector<double>& scratch) {
  sizes.resize(residuals.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) sizes[i] = std::abs(residuals[i]);
  return std::max(1.4826 * middle_of(sizes, scratch), 1e-4);
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
  const std::size_t count = points.size();
  std::vector<Eigen::Vector3d> rays(count);
  std::vector<double> ranges(count), residuals(count), sizes, scratch;
  for (std::size_t i = 0; i < count; ++i) {
    ranges[i] = points[i].norm();
    rays[i] = points[i] / ranges[i];
  }
  // The plane as m = n / d: the range along the unit ray f is -1 / (m . f),
  // whose derivative is range^2 f.
  Eigen::Vector3d m = start.normal / start.offset;
  const auto measure = [&] {
    const double least = 1e-3 * m.norm();
    for (std::size_t i = 0; i < count; ++i) {
      residuals[i] = ranges[i] + 1 / std::min(m.dot(rays[i]), -least);
    }
  };
  for (int iteration = 0; iteration < 6; ++iteration) {
    measure();
    fit.sigma = robust_scale(residuals, sizes, scratch);
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const double weight = tukey_weight(residuals[i] / fit.sigma);
      if (weight == 0) continue;
      const double predicted = ranges[i] - residuals[i];
      const Eigen::Vector3d J = predicted * predicted * rays[i], weighted = weight * J;
      H.col(0) += weighted.x() * J;
      H.col(1) += weighted.y() * J;
      H.col(2) += weighted.z() * J;
      g += residuals[i] * weighted;
    }
    // Two rings fix the plane only just; a tiny ridge keeps points on a line
    // from throwing it about.
    H.diagonal().array() += 1e-9 * H.trace();
    const Eigen::Vector3d step = H.ldlt().solve(g);
    if (!step.allFinite() || (m + step).norm() < 1e-3) break;
    m += step;
    if (step.norm() < 1e-6 * m.norm()) break;
  }
  fit.plane = {m.normalized(), 1 / m.norm()};
  measure();
  double sum = 0;
  for (const double r : residuals) sum += r * r;
  fit.rms = std::sqrt(sum / static_cast<double>(count));
  return fit;
}

}  // namespace ca2
