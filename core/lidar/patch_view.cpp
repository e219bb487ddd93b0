#include "core/lidar/patch_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// What meets the plane, in single precision.
struct Disc {
  float nx, ny, nz, offset;  ///< the plane
  Eigen::Vector3f origin, e_u, e_v;
  float limit;  ///< m, radius
};

/// Of a ring's rays: one point of each, and where they meet the plane.
struct RayLanes {
  explicit RayLanes(std::size_t most) : memory_(8 * most), most_(most) {}

  // Points, m; `across`: horizontal distance from the z axis.
  float* x() { return &memory_[0]; }
  float* y() { return &memory_[most_]; }
  float* z() { return &memory_[2 * most_]; }
  float* across() { return &memory_[3 * most_]; }
  // As PatchRay; `meets`: 0 where a ray does not meet the disc.
  float* u() { return &memory_[4 * most_]; }
  float* v() { return &memory_[5 * most_]; }
  float* distance() { return &memory_[6 * most_]; }
  float* meets() { return &memory_[7 * most_]; }

 private:
  std::vector<float> memory_;
  std::size_t most_;
};

CA2_HOT_LOOP void meet(const Disc& disc, float slope, float height, std::size_t size,
                       const float* __restrict x, const float* __restrict y, const float* __restrict z,
                       const float* __restrict across, float* __restrict out_u, float* __restrict out_v,
                       float* __restrict distance, float* __restrict meets) {
  const float nx = disc.nx, ny = disc.ny, nz = disc.nz, d = disc.offset, square = disc.limit * disc.limit;
  const float ox = disc.origin.x(), oy = disc.origin.y(), oz = disc.origin.z();
  const float ux = disc.e_u.x(), uy = disc.e_u.y(), uz = disc.e_u.z();
  const float vx = disc.e_v.x(), vy = disc.e_v.y(), vz = disc.e_v.z();
  const float rise = nz * slope, before = -(d + nz * height);
  for (std::size_t i = 0; i < size; ++i) {
    const float toward = nx * x[i] + ny * y[i] + rise * across[i];
    const float scale = before / toward;
    const float px = scale * x[i] - ox, py = scale * y[i] - oy;
    const float pz = height + scale * across[i] * slope - oz;
    const float u = ux * px + (uy * py + uz * pz), v = vx * px + (vy * py + vz * pz);
    out_u[i] = u;
    out_v[i] = v;
    distance[i] = nx * x[i] + (ny * y[i] + nz * z[i]) + d;
    const bool passes = toward > -1e-3f * across[i], away = scale <= 0, beyond = u * u + v * v > square;
    meets[i] = (passes | away | beyond) ? 0.0f : 1.0f;
  }
}

}  // namespace

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
  const auto limit = static_cast<float>(radius);
  const Disc disc{n.x(),
                  n.y(),
                  n.z(),
                  static_cast<float>(frame.plane.offset),
                  origin,
                  frame.e_u.cast<float>(),
                  frame.e_v.cast<float>(),
                  limit};
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
  RayLanes lanes(2 * static_cast<std::size_t>(half) + 1);
  std::vector<std::uint32_t> cells(2 * static_cast<std::size_t>(half) + 1);
  for (int row = low; row <= high; row += row_step) {
    const float slope = image.slope[static_cast<std::size_t>(row)],
                height = image.height[static_cast<std::size_t>(row)];
    const std::size_t first = image.index(row, 0);
    std::size_t size = 0;
    int column = (middle - half + image.columns) % image.columns;
    for (int k = -half; k <= half; k += column_step, column = image.wrap(column + column_step)) {
      if (!image.in_view[static_cast<std::size_t>(column)]) continue;
      const std::size_t i = first + static_cast<std::size_t>(column);
      const bool absent = image.range[i] == 0;
      // Some point of the ray's cone, at the column's azimuth where nothing
      // came back.
      const Eigen::Vector3f& p = absent ? image.direction[static_cast<std::size_t>(column)] : image.point(i);
      lanes.x()[size] = p.x();
      lanes.y()[size] = p.y();
      lanes.z()[size] = p.z();
      lanes.across()[size] = absent ? 1.0f : std::sqrt(p.x() * p.x() + p.y() * p.y());
      cells[size++] = static_cast<std::uint32_t>(i);
    }
    meet(disc, slope, height, size, lanes.x(), lanes.y(), lanes.z(), lanes.across(), lanes.u(), lanes.v(),
         lanes.distance(), lanes.meets());
    for (std::size_t k = 0; k < size; ++k) {
      if (lanes.meets()[k] == 0) continue;
      // Written where it stays: a copy would wait for its parts.
      PatchRay& ray = rays.emplace_back();
      ray.u = lanes.u()[k];
      ray.v = lanes.v()[k];
      ray.end = RayEnd::absent;
      ray.row = static_cast<std::uint16_t>(row);
      ray.cell = cells[k];
      if (image.range[cells[k]] == 0) continue;
      ray.distance = lanes.distance()[k];
      ray.end = ray.distance > band ? RayEnd::front : ray.distance < -band ? RayEnd::behind : RayEnd::on;
    }
  }
  return rays;
}

}  // namespace ca2
