#include "tools/ca2/rig_doubts.h"

#include "drivers/lidar/model.h"

namespace ca2 {

std::vector<Problem> rig_doubts(const Rig& rig, const std::string& file) {
  std::vector<Problem> doubts;
  for (const auto& [name, lidar] : rig.lidars) {
    if (lidar.model.empty()) continue;
    const auto model = find_lidar_model(lidar.model);
    if (model) continue;
    const Problem& unknown = model.error().problems.front();
    doubts.push_back({file, name + ": " + unknown.what, unknown.hint});
  }
  return doubts;
}

}  // namespace ca2
