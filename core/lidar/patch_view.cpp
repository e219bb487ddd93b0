#include "core/lidar/patch_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ca2 {

PatchFrame::PatchFrame(const Plane& p, const Eigen::Vector3d& near_point) : plane(p) {
  origin = near_point - p.distance(near_point) * p.normal;
  const Eigen::Vector3d axis =
      std::abs(p.normal.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  e_u = axis.cross(p.normal).normalized();
  e_v = e_u.cross(p.normal);
}

std::vector<PatchRay> view_patch(const RingImage& image, const PatchFrame& frame, double radius, double band,
                                 std::size_t most) {
  std::vector<PatchRay> rays;
  const Eigen::Vector3f n = frame.plane.normal.cast<float>(), origin = frame.origin.cast<float>();
  const Eigen::Vector3f e_u = frame.e_u.cast<float>(), e_v = frame.e_v.cast<float>();
  const auto d = static_cast<float>(frame.plane.offset), limit = static_cast<float>(radius);
  const float rho = std::hypot(origin.x(), origin.y());
  if (rho < limit) return rays;  // around or over the sensor: no picture of it
  const float half_angle = std::asin(limit / rho);
  const int half = std::min(static_cast<int>(half_angle / image.column_angle) + 1, image.columns / 2 - 1);
  const float azimuth = std::atan2(origin.y(), origin.x());
  const int middle = static_cast<int>((std::numbers::pi_v<float> - azimuth) / image.column_angle);
  const auto reaches = [&](int row) {
    // The steepest cone still meets the disc within rho +- limit.
    const float slope = image.slope[static_cast<std::size_t>(row)],
                height = image.height[static_cast<std::size_t>(row)];
    return std::abs(height + slope * rho - origin.z()) < limit * (1 + std::abs(slope));
  };
  int low = 0, high = image.rows - 1;
  while (low < image.rows && !reaches(low)) ++low;
  while (high > low && !reaches(high)) --high;
  int row_step = 1, column_step = 1;
  const auto count = [&] {
    return static_cast<std::size_t>(high - low + 1) / row_step * (2 * static_cast<std::size_t>(half) + 1) /
           column_step;
  };
  while (low <= high && count() > most) {
    // Thin the denser direction.
    const float rows =
        image.row_angle[static_cast<std::size_t>((low + high) / 2)] * static_cast<float>(row_step);
    (rows < image.column_angle * static_cast<float>(column_step) ? row_step : column_step) *= 2;
  }
  if (low <= high) rays.reserve(count() + 1);
  for (int row = low; row <= high; row += row_step) {
    const float slope = image.slope[static_cast<std::size_t>(row)],
                height = image.height[static_cast<std::size_t>(row)];
    const std::size_t first = image.index(row, 0);
    int column = (middle - half + image.columns) % image.columns;
    for (int k = -half; k <= half; k += column_step, column = image.wrap(column + column_step)) {
      if (!image.in_view[static_cast<std::size_t>(column)]) continue;
      const std::size_t i = first + static_cast<std::size_t>(column);
      const bool absent = image.range[i] == 0;
      // Some point of the ray's cone, at the column's azimuth where nothing
      // came back.
      const Eigen::Vector3f p = absent ? image.direction[static_cast<std::size_t>(column)] : image.point(i);
      const float across = absent ? 1.0f : std::sqrt(p.x() * p.x() + p.y() * p.y());
      const float toward = n.x() * p.x() + n.y() * p.y() + n.z() * slope * across;
      if (toward > -1e-3f * across) continue;
      const float scale = -(d + n.z() * height) / toward;
      if (scale <= 0) continue;
      const Eigen::Vector3f meets =
          Eigen::Vector3f(scale * p.x(), scale * p.y(), height + scale * across * slope) - origin;
      const float u = e_u.dot(meets), v = e_v.dot(meets);
      if (u * u + v * v > limit * limit) continue;
      // Written where it stays: a copy would wait for its parts.
      PatchRay& ray = rays.emplace_back();
      ray.u = u;
      ray.v = v;
      ray.end = RayEnd::absent;
      ray.cell = static_cast<std::uint32_t>(i);
      if (absent) continue;
      ray.distance = n.dot(p) + d;
      ray.end = ray.distance > band ? RayEnd::front : ray.distance < -band ? RayEnd::behind : RayEnd::on;
    }
  }
  return rays;
}

}  // namespace ca2
