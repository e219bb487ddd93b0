// Velodyne HDL-32E. HDL-32E User Manual 63-9113, appendix on data packets and firing sequence.
#include "drivers/lidar/model.h"

namespace ca2 {

LidarModel lidar_model_hdl_32e() {
  VelodyneModel model;
  model.lasers = 32;
  model.product_ids = {0x21};
  model.distance_lsb = 0.002;
  model.cycle = 46.080e-6;
  for (int laser = 0; laser < 32; ++laser) model.firing.push_back(1.152e-6 * laser);
  model.min_range = 0.5;
  model.max_range = 130;
  model.factory = velodyne_factory_table(
      {{-30.67, 0}, {-9.33, 0}, {-29.33, 0}, {-8, 0},    {-28, 0},    {-6.67, 0}, {-26.67, 0}, {-5.33, 0},
       {-25.33, 0}, {-4, 0},    {-24, 0},    {-2.67, 0}, {-22.67, 0}, {-1.33, 0}, {-21.33, 0}, {0, 0},
       {-20, 0},    {1.33, 0},  {-18.67, 0}, {2.67, 0},  {-17.33, 0}, {4, 0},     {-16, 0},    {5.33, 0},
       {-14.67, 0}, {6.67, 0},  {-13.33, 0}, {8, 0},     {-12, 0},    {9.33, 0},  {-10.67, 0}, {10.67, 0}});
  return {"HDL-32E", model};
}

}  // namespace ca2
