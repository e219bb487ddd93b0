#include "core/lidar/ring_image.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

/// Returns of several sweeps in one cell: the mean of those near the (lower) median range, so that neither
/// a passer-by nor a mixed pixel moves the point, and noise averages out.
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

}  // namespace

RingImage make_ring_image(const Projection& projection, const Scan& scan) {
  RingImage image;
  image.rows = static_cast<int>(projection.by_elevation.size());
  image.columns = projection.columns;
  image.column_angle = static_cast<float>(projection.column_angle());
  image.ring = projection.by_elevation;
  for (const int ring : image.ring) {
    image.slope.push_back(projection.slope[static_cast<std::size_t>(ring)]);
    image.height.push_back(projection.height[static_cast<std::size_t>(ring)]);
  }
  for (std::size_t row = 0; row + 1 < image.slope.size(); ++row) {
    image.row_angle.push_back(std::atan(image.slope[row + 1]) - std::atan(image.slope[row]));
  }
  if (image.rows > 0) image.row_angle.push_back(image.rows > 1 ? image.row_angle.back() : 1.0f);
  const std::size_t cells = static_cast<std::size_t>(image.rows) * image.columns;
  image.range.assign(cells, 0.0f);
  image.point.assign(cells, Eigen::Vector3f::Zero());
  image.in_view.assign(static_cast<std::size_t>(image.columns), 0);
  std::vector<float> ranges;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const auto cell = projection.cell(image.ring[static_cast<std::size_t>(row)], column);
      if (cell.empty()) continue;
      const std::size_t i = image.index(row, column);
      image.point[i] = cell.size() == 1 ? scan.points[cell[0]] : gathered_point(scan, cell, ranges);
      image.range[i] = image.point[i].norm();
      image.in_view[static_cast<std::size_t>(column)] = 1;
    }
  }
  return image;
}

}  // namespace ca2
