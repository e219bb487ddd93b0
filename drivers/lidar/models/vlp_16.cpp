// Velodyne VLP-16 (Puck, Puck LITE) and Puck Hi-Res. VLP-16 User Manual 63-9243: sections 6, 9 and appendix.
#include "drivers/lidar/model.h"

namespace ca2 {
namespace {

VelodyneModel puck() {
  VelodyneModel model;
  model.lasers = 16;
  model.distance_lsb = 0.002;
  model.cycle = 55.296e-6;
  for (int laser = 0; laser < 16; ++laser) model.firing.push_back(2.304e-6 * laser);
  model.min_range = 0.4;
  model.max_range = 130;
  return model;
}

}  // namespace

LidarModel lidar_model_vlp_16() {
  VelodyneModel model = puck();
  model.product_ids = {0x22, 0x21};  // units with firmware of 2014 call themselves HDL-32E
  std::vector<VelodyneAngles> angles;
  for (int pair = 0; pair < 8; ++pair) {
    angles.push_back({-15.0 + 2 * pair, 0});
    angles.push_back({1.0 + 2 * pair, 0});
  }
  model.factory = velodyne_factory_table(angles);
  return {"VLP-16", model};
}

LidarModel lidar_model_puck_hi_res() {
  VelodyneModel model = puck();
  model.product_ids = {0x24};
  model.factory = velodyne_factory_table({{-10, 0},
                                          {0.6667, 0},
                                          {-8.6667, 0},
                                          {2, 0},
                                          {-7.3333, 0},
                                          {3.3333, 0},
                                          {-6, 0},
                                          {4.6667, 0},
                                          {-4.6667, 0},
                                          {6, 0},
                                          {-3.3333, 0},
                                          {7.3333, 0},
                                          {-2, 0},
                                          {8.6667, 0},
                                          {-0.6667, 0},
                                          {10, 0}});
  return {"Puck-Hi-Res", model};
}

}  // namespace ca2
