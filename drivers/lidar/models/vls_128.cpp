// Velodyne VLS-128 (Alpha Prime / Alpha Puck). VLS-128 User Manual 63-9483: 16 groups of 8 lasers, a pause
// after the eighth group. The elevations are the nominal ones of the ROS drivers' parameter file.
#include "drivers/lidar/model.h"

namespace ca2 {
namespace {

constexpr double elevations[128] = {
    -11.742, -1.99,   3.4,    -5.29,  -0.78, 4.61,    -4.08,   1.31,     // 0
    -6.5,    -1.11,   4.28,   -4.41,  0.1,   6.48,    -3.2,    2.19,     // 8
    -3.86,   1.53,    -9.244, -1.77,  2.74,  -5.95,   -0.56,   4.83,     // 16
    -2.98,   2.41,    -6.28,  -0.89,  3.62,  -5.07,   0.32,    7.58,     // 24
    -0.34,   5.18,    -3.64,  1.75,   -25,   -2.43,   2.96,    -5.73,    // 32
    0.54,    9.7,     -2.76,  2.63,   -7.65, -1.55,   3.84,    -4.85,    // 40
    3.18,    -5.51,   -0.12,  5.73,   -4.3,  1.09,    -16.042, -2.21,    // 48
    4.06,    -4.63,   0.76,   15,     -3.42, 1.97,    -6.85,   -1.33,    // 56
    -5.62,   -0.23,   5.43,   -3.53,  0.98,  -19.582, -2.32,   3.07,     // 64
    -4.74,   0.65,    11.75,  -2.65,  1.86,  -7.15,   -1.44,   3.95,     // 72
    -2.1,    3.29,    -5.4,   -0.01,  4.5,   -4.19,   1.2,     -13.565,  // 80
    -1.22,   4.17,    -4.52,  0.87,   6.08,  -3.31,   2.08,    -6.65,    // 88
    1.42,    -10.346, -1.88,  3.51,   -6.06, -0.67,   4.72,    -3.97,    // 96
    2.3,     -6.39,   -1,     4.39,   -5.18, 0.21,    6.98,    -3.09,    // 104
    4.98,    -3.75,   1.64,   -8.352, -2.54, 2.85,    -5.84,   -0.45,    // 112
    8.43,    -2.87,   2.52,   -6.17,  -1.66, 3.73,    -4.96,   0.43,     // 120
};
constexpr double rotations[8] = {-6.354, -4.548, -2.732, -0.911, 0.911, 2.732, 4.548, 6.354};

}  // namespace

LidarModel lidar_model_vls_128() {
  VelodyneModel model;
  model.lasers = 128;
  model.product_ids = {0xA1, 0x63};  // one manual prints 99, sensors send 161
  model.distance_lsb = 0.004;
  model.cycle = 53.3e-6;  // 55.3 and 57.8 us in newer firmware
  model.cycle_from_timestamps = true;
  model.epoch = -8.7e-6;  // the time stamp is that of the fourth group
  std::vector<VelodyneAngles> angles;
  for (int laser = 0; laser < 128; ++laser) {
    const int group = laser / 8;
    model.firing.push_back(model.cycle / 20 * (group + group / 8));
    angles.push_back({elevations[laser], rotations[laser % 8]});
  }
  model.min_range = 0.5;
  model.max_range = 260;
  model.factory = velodyne_factory_table(angles);
  return {"VLS-128", model};
}

}  // namespace ca2
