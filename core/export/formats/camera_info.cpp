/// ROS camera_info YAML, as camera_info_manager reads it; distortion models of sensor_msgs (REP 104).
#include "core/export/distortion.h"
#include "core/export/selection.h"
#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

std::string matrix(const char* name, int rows, int columns, const std::vector<double>& data) {
  return std::string(name) + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
         "\n  data: " + exact_list(data.data(), data.size()) + "\n";
}

}  // namespace

Result<ExportFiles> export_camera_info(const ExportRequest& request) {
  if (!request.children.empty()) {
    return inexpressible("camera_info", "it has no place for the pose of '" + request.children.front() + "'",
                         "leave --child out; --format ros or urdf carry poses");
  }
  const auto cameras = select_cameras(request, "camera_info");
  if (!cameras) return fail(cameras.error());
  ExportFiles files;
  for (const ExportCamera& selected : *cameras) {
    const Camera& camera = selected.calibrated->camera;
    const auto distortion = opencv_distortion(camera, "camera_info");
    if (!distortion) return fail(distortion.error());
    const double fx = camera.parameters(0), fy = camera.parameters(1);
    const double cx = camera.parameters(2), cy = camera.parameters(3);
    std::string out = hash_comments(request);
    out += "image_width: " + std::to_string(camera.width) + "\n";
    out += "image_height: " + std::to_string(camera.height) + "\n";
    out += "camera_name: " + yaml_string(selected.name) + "\n";
    out += matrix("camera_matrix", 3, 3, {fx, 0, cx, 0, fy, cy, 0, 0, 1});
    out += "distortion_model: " + distortion->ros_name + "\n";
    out += matrix("distortion_coefficients", 1, static_cast<int>(distortion->coefficients.size()),
                  distortion->coefficients);
    out += matrix("rectification_matrix", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    out += matrix("projection_matrix", 3, 4, {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0});
    files.push_back({selected.name + ".yaml", out});
  }
  return files;
}

}  // namespace ca2
