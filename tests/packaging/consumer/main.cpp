/// Uses Ca2 from outside: reads a rig, looks for its board in a picture of it, and names the LiDARs and
/// camera drivers that the libraries know. Prints what it found.
#include <cstdio>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/io/files.h"
#include "core/session/rig.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/lidar/model.h"

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  const ca2::Result<ca2::Rig> rig = ca2::read_rig(argv[1]);
  if (!rig) return std::fprintf(stderr, "%s\n", rig.error().text().c_str()), 1;
  const ca2::Result<ca2::Image> page = ca2::read_png(argv[2]);
  if (!page) return std::fprintf(stderr, "%s\n", page.error().text().c_str()), 1;
  const auto corners = ca2::detect_board(rig->board, *page);
  std::printf("%zu of %zu corners\n", corners.size(), rig->board.type->corners(rig->board).size());
  for (const ca2::CameraDriver* driver : ca2::camera_drivers()) {
    std::printf("%.*s ", static_cast<int>(driver->name.size()), driver->name.data());
  }
  for (const ca2::LidarModel& model : ca2::lidar_models()) std::printf("%s ", model.name.c_str());
  std::printf("\n");
  return corners.empty();
}
