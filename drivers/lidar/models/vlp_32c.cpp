// Velodyne VLP-32C (Ultra Puck). VLP-32C User Manual 63-9325: two lasers fire together every 2.304 us.
#include "drivers/lidar/model.h"

namespace ca2 {

LidarModel lidar_model_vlp_32c() {
  VelodyneModel model;
  model.lasers = 32;
  model.product_ids = {0x28};
  model.distance_lsb = 0.004;
  model.cycle = 55.296e-6;
  for (int laser = 0; laser < 32; ++laser) model.firing.push_back(2.304e-6 * (laser / 2));
  model.min_range = 0.5;
  model.max_range = 220;
  model.factory = velodyne_factory_table(
      {{-25, -1.4},    {-1, 4.2},     {-1.667, -1.4}, {-15.639, 1.4}, {-11.31, -1.4}, {0, 1.4},
       {-0.667, -4.2}, {-8.843, 1.4}, {-7.254, -1.4}, {0.333, 4.2},   {-0.333, -1.4}, {-6.148, 1.4},
       {-5.333, -4.2}, {1.333, 1.4},  {0.667, -4.2},  {-4, 1.4},      {-4.667, -1.4}, {1.667, 4.2},
       {1, -1.4},      {-3.667, 4.2}, {-3.333, -4.2}, {3.333, 1.4},   {2.333, -1.4},  {-2.667, 1.4},
       {-3, -1.4},     {7, 1.4},      {4.667, -1.4},  {-2.333, 4.2},  {-2, -4.2},     {15, 1.4},
       {10.333, -1.4}, {-1.333, 1.4}});
  return {"VLP-32C", model};
}

}  // namespace ca2
