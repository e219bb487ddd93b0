/// @file The projection by ID as the finder works on it: one point per cell, rows in order of elevation.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lidar/projection.h"
#include "core/types/scan.h"

namespace ca2 {

/// The neighbourhood of the finder. Columns wrap around.
struct RingImage {
  int rows = 0;  ///< rings with returns, lowest first
  int columns = 0;
  float column_angle = 0;              ///< rad
  std::vector<int> ring;               ///< [row] the projection's ring
  std::vector<float> slope, height;    ///< [row] the cone, as in Projection
  std::vector<float> row_angle;        ///< [row] rad to the next row (the last: from the one before)
  std::vector<float> range;            ///< [row * columns + column] m, from the origin; 0: nothing came back
  std::vector<Eigen::Vector3f> point;  ///< m; mean of the cell's returns where they agree
  std::vector<std::uint8_t> in_view;   ///< [column] something came back in some row

  std::size_t index(int row, int column) const { return static_cast<std::size_t>(row) * columns + column; }
  int wrap(int column) const {
    return column < 0 ? column + columns : column >= columns ? column - columns : column;
  }
};

RingImage make_ring_image(const Projection& projection, const Scan& scan);

}  // namespace ca2
