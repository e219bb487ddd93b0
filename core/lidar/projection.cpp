#include "core/lidar/projection.h"

#include <algorithm>
#include <limits>

#include "core/lidar/scan_grid.h"

namespace ca2 {
namespace {

/// Per ring the straight line z = height + slope * rho through its returns: beams of one ring lie on a cone
/// whose apex need not be the origin. A ring whose returns are all equally far says nothing about the apex,
/// which then is taken for the origin: the ridge stands for a prior of about 0.2 m.
void fit_cones(const Scan& scan, const RingIds& rings, Projection& out) {
  struct Sums {
    double n = 0, r = 0, rr = 0, z = 0, rz = 0;
  };
  std::vector<Sums> sums(static_cast<std::size_t>(rings.rings));
  const std::size_t step = scan.size() > 60000 ? 3 : 1;
  for (std::size_t i = 0; i < scan.size(); i += step) {
    if (rings.ring[i] == RingIds::none) continue;
    const Eigen::Vector3f& p = scan.points[i];
    const double r = std::sqrt(p.x() * p.x() + p.y() * p.y());
    Sums& s = sums[rings.ring[i]];
    s.n += 1, s.r += r, s.rr += r * r, s.z += p.z(), s.rz += r * p.z();
  }
  const float nan = std::numeric_limits<float>::quiet_NaN();
  out.slope.assign(sums.size(), nan);
  out.height.assign(sums.size(), 0);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const Sums& s = sums[k];
    if (s.n == 0 || s.rr == 0) continue;
    const double n = s.n + (rings.beams ? 0.02 : 1e12), determinant = n * s.rr - s.r * s.r;
    out.height[k] = static_cast<float>((s.z * s.rr - s.r * s.rz) / determinant);
    out.slope[k] = static_cast<float>((s.rz - out.height[k] * s.r) / s.rr);
    out.by_elevation.push_back(static_cast<int>(k));
  }
  std::sort(out.by_elevation.begin(), out.by_elevation.end(), [&](int a, int b) {
    return out.slope[static_cast<std::size_t>(a)] < out.slope[static_cast<std::size_t>(b)];
  });
}

template <class Value>
std::vector<float> nearest_image(const Projection& projection, const Scan& scan, Value value) {
  std::vector<float> image(static_cast<std::size_t>(projection.rings) * projection.columns, 0.0f);
  for (std::size_t i = 0; i < image.size(); ++i) {
    float nearest = std::numeric_limits<float>::max();
    for (std::uint32_t k = projection.first[i]; k < projection.first[i + 1]; ++k) {
      const std::uint32_t index = projection.returns[k];
      const float range = scan.points[index].norm();
      if (range < nearest) nearest = range, image[i] = value(index, range);
    }
  }
  return image;
}

}  // namespace

double Projection::column_angle() const {
  return 2 * std::numbers::pi / std::max(columns, 1);
}

Projection project_by_id(const Scan& scan) {
  const RingIds rings = find_rings(scan);
  const ColumnIds columns = find_columns(scan, rings);
  Projection out;
  out.rings = rings.rings;
  out.columns = columns.columns;
  out.beams = rings.beams;
  // Counting sort by cell; the scan's order is kept within a cell.
  out.first.assign(static_cast<std::size_t>(out.rings) * out.columns + 1, 0);
  const auto cell_of = [&](std::size_t i) {
    return static_cast<std::size_t>(rings.ring[i]) * out.columns + columns.column[i];
  };
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (rings.ring[i] != RingIds::none) ++out.first[cell_of(i) + 1];
  }
  for (std::size_t i = 1; i < out.first.size(); ++i) out.first[i] += out.first[i - 1];
  out.returns.resize(out.first.back());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (rings.ring[i] != RingIds::none) out.returns[next[cell_of(i)]++] = static_cast<std::uint32_t>(i);
  }
  fit_cones(scan, rings, out);
  return out;
}

std::vector<float> range_image(const Projection& projection, const Scan& scan) {
  return nearest_image(projection, scan, [](std::uint32_t, float range) { return range; });
}

std::vector<float> intensity_image(const Projection& projection, const Scan& scan) {
  const bool known = scan.intensity.size() == scan.size();
  return nearest_image(projection, scan,
                       [&](std::uint32_t i, float) { return known ? scan.intensity[i] : 0.0f; });
}

}  // namespace ca2
