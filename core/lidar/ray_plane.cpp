#include "core/lidar/ray_plane.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/types/hot_loop.h"

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

/// Returns as unit rays and ranges (m), and what a plane leaves of these.
struct Ranges {
  explicit Ranges(std::span<const Eigen::Vector3d> points) : size(points.size()) {
    for (std::vector<double>* list : {&x, &y, &z, &range, &residual, &absolute, &weight}) list->resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      range[i] = points[i].norm();
      const Eigen::Vector3d ray = points[i] / range[i];
      x[i] = ray.x(), y[i] = ray.y(), z[i] = ray.z();
    }
  }

  std::size_t size;
  std::vector<double> x, y, z, range;
  std::vector<double> residual, absolute;  ///< m, and without its sign
  std::vector<double> weight;
};

/// Residuals against the plane m = n / d: the range along the unit ray f is -1 / (m . f).
CA2_HOT_LOOP void measure(double mx, double my, double mz, double least, std::size_t size,
                          const double* __restrict x, const double* __restrict y, const double* __restrict z,
                          const double* __restrict range, double* __restrict residual,
                          double* __restrict absolute) {
  for (std::size_t i = 0; i < size; ++i) {
    const double along = mx * x[i] + my * y[i] + mz * z[i];
    residual[i] = range[i] + 1 / (along < -least ? along : -least);
    absolute[i] = std::abs(residual[i]);
  }
}

void measure(const Eigen::Vector3d& m, Ranges& ranges) {
  measure(m.x(), m.y(), m.z(), 1e-3 * m.norm(), ranges.size, ranges.x.data(), ranges.y.data(),
          ranges.z.data(), ranges.range.data(), ranges.residual.data(), ranges.absolute.data());
}

/// Tukey's.
CA2_HOT_LOOP void weigh(double sigma, std::size_t size, const double* __restrict residual,
                        double* __restrict weight) {
  constexpr double kCut = 4.685;  // 95 % efficiency under normal noise
  for (std::size_t i = 0; i < size; ++i) {
    const double x = residual[i] / sigma / kCut, t = 1 - x * x;
    weight[i] = t > 0 ? t * t : 0;
  }
}

}  // namespace

double range_residual(const Plane& plane, const Eigen::Vector3d& point) {
  const double range = point.norm(), toward = plane.normal.dot(point) / range;
  return range + plane.offset / std::min(toward, -1e-3);
}

RangeFit fit_ranges(std::span<const Eigen::Vector3d> points, const Plane& start) {
  RangeFit fit{start, 0, 0};
  if (points.size() < 3 || start.offset <= 0) return fit;
  Ranges ranges(points);
  std::vector<double> scratch;
  // The range's derivative with respect to m is range^2 f.
  Eigen::Vector3d m = start.normal / start.offset;
  for (int iteration = 0; iteration < 6; ++iteration) {
    measure(m, ranges);
    // 1.4826 times the median absolute residual: the standard deviation of normal noise.
    fit.sigma = std::max(1.4826 * middle_of(ranges.absolute, scratch), 1e-4);
    weigh(fit.sigma, ranges.size, ranges.residual.data(), ranges.weight.data());
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < ranges.size; ++i) {
      const double weight = ranges.weight[i];
      if (weight == 0) continue;
      const double predicted = ranges.range[i] - ranges.residual[i];
      const Eigen::Vector3d J =
          predicted * predicted * Eigen::Vector3d(ranges.x[i], ranges.y[i], ranges.z[i]);
      const Eigen::Vector3d weighted = weight * J;
      H.col(0) += weighted.x() * J;
      H.col(1) += weighted.y() * J;
      H.col(2) += weighted.z() * J;
      g += ranges.residual[i] * weighted;
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
  measure(m, ranges);
  double sum = 0;
  for (const double r : ranges.residual) sum += r * r;
  fit.rms = std::sqrt(sum / static_cast<double>(ranges.size));
  return fit;
}

}  // namespace ca2
