/// OpenCV's FileStorage YAML: camera_matrix and distortion_coefficients by the names its samples use, and the
/// pose of the LiDAR as R and T.
#include "core/export/distortion.h"
#include "core/export/selection.h"
#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

std::string matrix(const std::string& indent, const char* name, int rows, int columns,
                   const std::vector<double>& data) {
  return indent + name + ": !!opencv-matrix\n" + indent + "   rows: " + std::to_string(rows) + "\n" + indent +
         "   cols: " + std::to_string(columns) + "\n" + indent + "   dt: d\n" + indent +
         "   data: " + exact_list(data.data(), data.size()) + "\n";
}

/// R and T with p_parent = R p_child + T.
std::string transform(const std::string& indent, const ExportTransform& t) {
  const Pose& T = t.connection.T;
  std::vector<double> R;
  for (int i = 0; i < 9; ++i) R.push_back(T.R(i / 3, i % 3));
  return indent + "parent_frame: \"" + t.parent + "\"\n" + indent + "child_frame: \"" + t.child + "\"\n" +
         matrix(indent, "R", 3, 3, R) + matrix(indent, "T", 3, 1, {T.t.x(), T.t.y(), T.t.z()});
}

}  // namespace

Result<ExportFiles> export_opencv(const ExportRequest& request) {
  const auto cameras = select_cameras(request, "opencv");
  if (!cameras) return fail(cameras.error());
  ExportFiles files;
  for (const ExportCamera& selected : *cameras) {
    const Camera& camera = selected.calibrated->camera;
    const auto distortion = opencv_distortion(camera, "opencv");
    if (!distortion) return fail(distortion.error());
    if (const auto names = check_frame_names(selected.transforms); !names) return fail(names.error());
    // Its readers take a file without this first line for something else.
    std::string out = "%YAML:1.0\n---\n" + hash_comments(request);
    out += "camera_name: \"" + selected.name + "\"\n";
    out += "image_width: " + std::to_string(camera.width) + "\n";
    out += "image_height: " + std::to_string(camera.height) + "\n";
    const auto& p = camera.parameters;
    out += matrix("", "camera_matrix", 3, 3, {p(0), 0, p(2), 0, p(1), p(3), 0, 0, 1});
    if (distortion->fisheye) out += "# of cv::fisheye\nfisheye_model: 1\n";
    out += matrix("", "distortion_coefficients", static_cast<int>(distortion->coefficients.size()), 1,
                  distortion->coefficients);
    if (selected.transforms.size() == 1) {
      out += transform("", selected.transforms.front());
    } else if (!selected.transforms.empty()) {
      out += "transforms:\n";
      for (const ExportTransform& t : selected.transforms) out += "   -\n" + transform("      ", t);
    }
    files.push_back({selected.name + ".yaml", out});
  }
  return files;
}

}  // namespace ca2
