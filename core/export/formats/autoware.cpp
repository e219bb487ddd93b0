/// Autoware's sensor_kit_calibration.yaml: under the parent, every child with x y z roll pitch yaw. Cameras
/// are named by their camera_link, not the optical frame. A LiDAR's own frame is meant, not its mount's:
/// between the two lies the vendor's offset, which --via and --child can bring in.
#include "core/export/rpy.h"
#include "core/export/selection.h"
#include "core/io/yaml_text.h"

namespace ca2 {

Result<ExportFiles> export_autoware(const ExportRequest& request) {
  const std::vector<std::string> lidars = lidar_names(request.calibration);
  std::vector<std::string> children = lidars;
  for (const auto& [name, camera] : request.calibration.cameras) {
    children.push_back(link_name(request.frames.frame_of(name)));
  }
  const auto transforms = select_tree(request, children.empty() ? "" : children.front(), children);
  if (!transforms) return fail(transforms.error());
  if (const auto names = check_frame_names(*transforms); !names) return fail(names.error());
  std::string out = hash_comments(request) + yaml_string(transforms->front().parent) + ":\n";
  for (const ExportTransform& t : *transforms) {
    const Pose& T = t.connection.T;
    const Eigen::Vector3d rpy = rpy_from_rotation(T.R);
    out += "  # " + sigma_text(t.connection) + "\n";
    if (near_gimbal_lock(rpy)) out += "  # the pitch is near 90 degrees: roll and yaw mean little alone\n";
    out += "  " + yaml_string(t.child) + ":\n";
    out += "    x: " + exact(T.t.x()) + "\n    y: " + exact(T.t.y()) + "\n    z: " + exact(T.t.z()) + "\n";
    out += "    roll: " + exact(rpy.x()) + "\n    pitch: " + exact(rpy.y()) + "\n    yaw: " + exact(rpy.z()) +
           "\n";
  }
  return ExportFiles{{"sensor_kit_calibration.yaml", out}};
}

}  // namespace ca2
