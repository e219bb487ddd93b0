#include "tools/ca2/rig_doubts.h"

#include "core/camera/distortion_doubt.h"
#include "drivers/lidar/model.h"
#include "tools/ca2/lidar_file.h"

namespace ca2 {

std::optional<Problem> camera_doubt(const Camera& camera, const std::string& file) {
  auto doubt = distortion_doubt(camera);
  if (!doubt) return std::nullopt;
  return Problem{file, std::move(*doubt),
                 "are these the coefficients of a " + std::string(camera.model->name()) + ", in its order?"};
}

std::vector<Problem> rig_doubts(const Rig& rig, const std::string& file) {
  std::vector<Problem> doubts;
  for (const auto& [name, camera] : rig.cameras) {
    if (!camera.intrinsics) continue;
    if (auto doubt = camera_doubt(*camera.intrinsics, file)) {
      doubt->what = name + ": " + doubt->what;
      doubts.push_back(std::move(*doubt));
    }
  }
  for (const auto& [name, lidar] : rig.lidars) {
    if (!lidar.metadata.empty()) {
      const auto own = metadata_doubts(std::filesystem::path(file).parent_path() / lidar.metadata);
      doubts.insert(doubts.end(), own.begin(), own.end());
    }
    if (lidar.model.empty()) continue;
    const auto model = find_lidar_model(lidar.model);
    if (model) continue;
    const Problem& unknown = model.error().problems.front();
    doubts.push_back({file, name + ": " + unknown.what, unknown.hint});
  }
  return doubts;
}

}  // namespace ca2
