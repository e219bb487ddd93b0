/// @file Range to point for an Ouster, with no trigonometry per point.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "drivers/lidar/ouster/metadata.h"

namespace ca2 {

/// The vendor's formula (Firmware User Manual, "Lidar Range to XYZ"), split into what depends on the row and
/// what depends on the column. With p = range - beam origin distance, row (a, b, c) and column (M, t):
///   point = M * (p * a + n_x, p * b, p * c + n_z) + t     [m, sensor frame]
struct OusterGeometry {
  /// Of a column: rotation by the encoder, then lidar_to_sensor.
  struct Column {
    Eigen::Matrix3d M;
    // In single precision, with the beams' origin where their ranges are 0.
    Eigen::Matrix3f turn;
    Eigen::Vector3f base;  ///< m
    /// As nearly all sensors are set up, z is that of the head: turn's third row and column are those of 1.
    bool upright;
  };
  /// Of rows, with the angles of their beams relative to the encoder: cos(altitude) cos(azimuth),
  /// cos(altitude) sin(azimuth), sin(altitude).
  Eigen::ArrayXd a, b, c;
  std::vector<Column> columns;
  /// a, b and c in single precision, readable up to the next multiple of lanes::count.
  std::vector<float> a_lanes, b_lanes, c_lanes;
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< m
  double origin_x = 0, origin_z = 0;            ///< m, beam origin
  double origin_range = 0;                      ///< m, subtracted from every range

  Eigen::Vector3d point(int row, int column, double range) const {
    const double p = range - origin_range;
    return columns[static_cast<std::size_t>(column)].M *
               Eigen::Vector3d(p * a[row] + origin_x, p * b[row], p * c[row] + origin_z) +
           t;
  }
};

OusterGeometry make_ouster_geometry(const OusterMetadata& metadata);

}  // namespace ca2
