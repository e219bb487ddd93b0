// Ouster OS0, OS1, OS2: nominal products for simulation; a real unit's angles are in its metadata. Field of
// view and range from the datasheets, beam origins as the vendor's library defaults them.
#include "drivers/lidar/model.h"

namespace ca2 {
namespace {

LidarModel os0(int beams) {
  return {"OS0-" + std::to_string(beams),
          OusterModel{"OS-0-" + std::to_string(beams), beams, 45.0, 2.8, 27.67, 0.3, 100}};
}
LidarModel os1(int beams) {
  return {"OS1-" + std::to_string(beams),
          OusterModel{"OS-1-" + std::to_string(beams), beams, 22.5, 1.4, 15.806, 0.3, 200}};
}
LidarModel os2(int beams) {
  return {"OS2-" + std::to_string(beams),
          OusterModel{"OS-2-" + std::to_string(beams), beams, 11.25, 0.7, 13.762, 0.8, 400}};
}

}  // namespace

LidarModel lidar_model_os0_32() {
  return os0(32);
}
LidarModel lidar_model_os0_64() {
  return os0(64);
}
LidarModel lidar_model_os0_128() {
  return os0(128);
}
LidarModel lidar_model_os1_16() {
  return os1(16);
}
LidarModel lidar_model_os1_32() {
  return os1(32);
}
LidarModel lidar_model_os1_64() {
  return os1(64);
}
LidarModel lidar_model_os1_128() {
  return os1(128);
}
LidarModel lidar_model_os2_32() {
  return os2(32);
}
LidarModel lidar_model_os2_64() {
  return os2(64);
}
LidarModel lidar_model_os2_128() {
  return os2(128);
}

}  // namespace ca2
