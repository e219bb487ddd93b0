#include "drivers/lidar/velodyne/velodyne_model.h"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace ca2 {

VelodyneCalibration velodyne_factory_table(const std::vector<VelodyneAngles>& degrees) {
  constexpr double radian = std::numbers::pi / 180;
  VelodyneCalibration calibration;
  for (const VelodyneAngles& angles : degrees) {
    VelodyneLaser laser;
    laser.vertical = angles.vertical * radian;
    laser.rotation = angles.rotation * radian;
    calibration.lasers.push_back(laser);
  }
  return calibration;
}

std::vector<int> velodyne_rings(const VelodyneCalibration& calibration) {
  std::vector<int> by_elevation(calibration.lasers.size());
  std::iota(by_elevation.begin(), by_elevation.end(), 0);
  std::stable_sort(by_elevation.begin(), by_elevation.end(), [&](int a, int b) {
    return calibration.lasers[a].vertical < calibration.lasers[b].vertical;
  });
  std::vector<int> rings(by_elevation.size());
  for (std::size_t ring = 0; ring < by_elevation.size(); ++ring) {
    rings[by_elevation[ring]] = static_cast<int>(ring);
  }
  return rings;
}

}  // namespace ca2
