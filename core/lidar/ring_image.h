/// @file The projection by ID as the finder works on it: one point per cell,
/// rows in order of elevation.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lidar/projection.h"
#include "core/types/scan.h"

namespace ca2 {

/// The neighbourhood of the finder: the cells of a projection, whose columns
/// wrap around. Looks into the projection it was made from, which must
/// outlive it.
struct RingImage {
  RingImage() = default;
  RingImage(RingImage&&) = default;
  RingImage& operator=(RingImage&&) = default;

  int rows = 0;  ///< rings with returns, lowest first
  int columns = 0;
  int stride = 0;                          ///< as in Projection
  float column_angle = 0;                  ///< rad
  std::vector<int> ring;                   ///< [row] the projection's ring
  std::vector<int> row_of;                 ///< [ring]
  std::vector<float> slope, height;        ///< [row] the cone, as in Projection
  std::vector<float> row_angle;            ///< [row] rad to the next row (the last: from the one before)
  std::span<const float> range;            ///< [cell] m, from the origin; 0: nothing came back
  std::vector<std::uint8_t> in_view;       ///< [column] something came back in some row
  std::vector<Eigen::Vector3f> direction;  ///< [column] its azimuth: horizontal, unit

  /// The projection's cell.
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(ring[static_cast<std::size_t>(row)]) * stride + column;
  }
  int row(std::uint32_t cell) const { return row_of[cell / static_cast<std::uint32_t>(stride)]; }
  int column(std::uint32_t cell) const { return static_cast<int>(cell % static_cast<std::uint32_t>(stride)); }
  /// Of a cell in that row: without a division.
  int column(std::uint32_t cell, int row) const { return static_cast<int>(cell - index(row, 0)); }
  int wrap(int column) const {
    return column < 0 ? column + columns : column >= columns ? column - columns : column;
  }
  /// m; mean of the cell's returns where they agree. Only where there are some.
  const Eigen::Vector3f& point(std::size_t cell) const { return points[cell]; }

  std::span<const Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> gathered;  ///< what they look into where cells have several returns
  std::vector<float> gathered_range;
};

/// `spare`: an image that is no longer needed, for its memory.
RingImage make_ring_image(const Projection& projection, const Scan& scan, RingImage spare = {});

}  // namespace ca2
