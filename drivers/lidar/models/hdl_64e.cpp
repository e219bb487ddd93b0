// Velodyne HDL-64E, S1 to S3. HDL-64E S3 User Manual 63-HDL64ES3. Every unit has its own calibration; the
// nominal one exists so that a simulator can be such a sensor.
#include <numbers>

#include "drivers/lidar/model.h"

namespace ca2 {
namespace {

VelodyneModel hdl_64e() {
  VelodyneModel model;
  model.lasers = 64;
  model.distance_lsb = 0.002;
  // S2; an S3 takes 57.6 us in the same pattern, which its time stamps show.
  model.cycle = 48.0e-6;
  model.cycle_from_timestamps = true;
  constexpr double quartet[] = {0, 1.26e-6, 2.46e-6, 3.66e-6};
  for (int laser = 0; laser < 64; ++laser) {
    const int channel = laser % 32;  // upper and lower block fire together
    model.firing.push_back(6.0e-6 * (channel / 4) + quartet[channel % 4]);
  }
  model.dual = VelodyneDual::groups;
  model.min_range = 0.9;
  model.max_range = 120;
  return model;
}

/// Even elevations as the brochure states them (upper block 1/3 degree apart from +2, lower 1/2 degree down
/// to -24.33) with offsets and distance corrections of the size real units have.
VelodyneCalibration nominal_calibration() {
  constexpr double radian = std::numbers::pi / 180;
  constexpr double rotations[] = {-5, -3, 3, 5, -1, 1, -3, 3};
  VelodyneCalibration calibration;
  for (int id = 0; id < 64; ++id) {
    const bool upper = id < 32;
    const int channel = id % 32;
    // Neighbouring channels are far apart in elevation, as in the real firing order.
    const int step = (channel % 2) * 16 + channel / 2;
    VelodyneLaser laser;
    laser.vertical = (upper ? 2.0 - step / 3.0 : -8.83 - step / 2.0) * radian;
    laser.rotation = rotations[channel % 8] * radian;
    laser.distance = 1.2;
    laser.vertical_offset = upper ? 0.20 : 0.13;
    laser.horizontal_offset = id % 2 == 0 ? 0.026 : -0.026;
    calibration.lasers.push_back(laser);
  }
  return calibration;
}

}  // namespace

LidarModel lidar_model_hdl_64e() {
  return {"HDL-64E", hdl_64e()};
}

LidarModel lidar_model_hdl_64e_nominal() {
  VelodyneModel model = hdl_64e();
  model.factory = nominal_calibration();
  return {"HDL-64E-nominal", model};
}

}  // namespace ca2
