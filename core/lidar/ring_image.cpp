#include "core/lidar/ring_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ca2 {
namespace {

constexpr float least_row_angle = 1e-5f;  // rad: a thousandth of what sensors have

/// Returns of several sweeps in one cell: the mean of those near the (lower)
/// median range, so that neither a passer-by nor a mixed pixel moves the point,
/// and noise averages out.
Eigen::Vector3f gathered_point(const Scan& scan, std::span<const std::uint32_t> cell,
                               std::vector<float>& ranges) {
  constexpr float kAgree = 0.06f;  // m, three times the noise of the worst sensor
  ranges.clear();
  for (const std::uint32_t i : cell) ranges.push_back(scan.points[i].norm());
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>((ranges.size() - 1) / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  const float median = *middle;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float count = 0;
  for (const std::uint32_t i : cell) {
    if (std::abs(scan.points[i].norm() - median) > kAgree) continue;
    sum += scan.points[i];
    ++count;
  }
  return sum / count;
}

void gather_cells(const Projection& projection, const Scan& scan, RingImage& image) {
  const std::size_t cells = projection.range.size();
  image.gathered.resize(cells);
  image.gathered_range.assign(cells, 0.0f);
  std::vector<float> ranges;
  for (std::size_t i = 0; i < cells; ++i) {
    const auto cell = projection.cell(i);
    if (cell.empty()) continue;
    image.gathered[i] = cell.size() == 1 ? scan.points[cell[0]] : gathered_point(scan, cell, ranges);
    image.gathered_range[i] = image.gathered[i].norm();
  }
  image.points = image.gathered;
  image.range = image.gathered_range;
}

}  // namespace

RingImage make_ring_image(const Projection& projection, const Scan& scan, RingImage spare) {
  RingImage image = std::move(spare);
  image.rows = static_cast<int>(projection.by_elevation.size());
  image.columns = projection.columns;
  image.stride = projection.stride;
  image.column_angle = static_cast<float>(projection.column_angle());
  image.ring = projection.by_elevation;
  image.row_of.assign(static_cast<std::size_t>(projection.rings), 0);
  image.slope.clear();
  image.height.clear();
  image.row_angle.clear();
  for (int row = 0; row < image.rows; ++row) {
    const auto ring = static_cast<std::size_t>(image.ring[static_cast<std::size_t>(row)]);
    image.row_of[ring] = row;
    image.slope.push_back(projection.slope[ring]);
    image.height.push_back(projection.height[ring]);
  }
  for (std::size_t row = 0; row + 1 < image.slope.size(); ++row) {
    // Rings may share an elevation, and much is divided by this.
    image.row_angle.push_back(
        std::max(least_row_angle, std::atan(image.slope[row + 1]) - std::atan(image.slope[row])));
  }
  if (image.rows > 0) image.row_angle.push_back(image.rows > 1 ? image.row_angle.back() : 1.0f);
  if (projection.one_per_cell()) {
    image.points = projection.point;
    image.range = projection.range;
  } else {
    gather_cells(projection, scan, image);
  }
  if (image.direction.size() != static_cast<std::size_t>(image.columns)) {
    image.direction.clear();
    for (int column = 0; column < image.columns; ++column) {
      const double azimuth = std::numbers::pi - column * projection.column_angle();
      image.direction.emplace_back(static_cast<float>(std::cos(azimuth)),
                                   static_cast<float>(std::sin(azimuth)), 0.0f);
    }
  }
  image.in_view.assign(static_cast<std::size_t>(image.columns), 0);
  for (int column = 0; column < image.columns; ++column) {
    for (int row = 0; row < image.rows && !image.in_view[static_cast<std::size_t>(column)]; ++row) {
      image.in_view[static_cast<std::size_t>(column)] = image.range[image.index(row, column)] > 0;
    }
  }
  return image;
}

}  // namespace ca2
