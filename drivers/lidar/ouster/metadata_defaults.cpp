#include "drivers/lidar/ouster/metadata_defaults.h"

#include <algorithm>
#include <cmath>

namespace ca2 {

double default_beam_origin_mm(std::string_view prod_line) {
  if (prod_line.starts_with("OS-0-")) return 27.67;
  if (prod_line.starts_with("OS-1-")) return 15.806;
  if (prod_line.starts_with("OS-2-")) return 13.762;
  return 12.163;
}

Eigen::Matrix4d default_lidar_to_sensor() {
  Eigen::Matrix4d transform = Eigen::Vector4d(-1, -1, 1, 1).asDiagonal();
  transform(2, 3) = 36.18;
  return transform;
}

Eigen::Matrix4d default_imu_to_sensor() {
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  transform.topRightCorner<3, 1>() = Eigen::Vector3d(6.253, -11.775, 7.645);
  return transform;
}

std::vector<int> default_pixel_shift(const std::vector<double>& azimuth, int columns) {
  std::vector<int> shift;
  for (const double degrees : azimuth) {
    shift.push_back(static_cast<int>(std::lround(std::remainder(degrees, 360.0) * columns / 360)));
  }
  const auto smallest = std::min_element(shift.begin(), shift.end());
  const int offset = smallest == shift.end() ? 0 : *smallest;
  for (int& value : shift) value -= offset;
  return shift;
}

}  // namespace ca2
