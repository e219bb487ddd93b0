/// @file What the vendor's library assumes where metadata is silent.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

namespace ca2 {

/// mm, by product line: 27.67 (OS0), 15.806 (OS1), 13.762 (OS2), 12.163 (first generation).
double default_beam_origin_mm(std::string_view prod_line);

/// Half a turn about z and 36.18 mm up; translation in mm.
Eigen::Matrix4d default_lidar_to_sensor();
Eigen::Matrix4d default_imu_to_sensor();

/// Columns by which each row is staggered, from the beams' azimuths (deg), the smallest one 0.
std::vector<int> default_pixel_shift(const std::vector<double>& azimuth, int columns);

}  // namespace ca2
