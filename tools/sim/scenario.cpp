#include "tools/sim/scenario.h"

namespace ca2 {

const Pose& Scenario::T_rig_sensor(const std::string& sensor) const {
  const auto camera = cameras.find(sensor);
  return camera != cameras.end() ? camera->second.T_rig_camera : lidars.at(sensor).T_rig_lidar;
}

std::mt19937_64 view_generator(const Scenario& scenario, int view) {
  std::seed_seq seeds{static_cast<std::uint32_t>(scenario.seed),
                      static_cast<std::uint32_t>(scenario.seed >> 32), static_cast<std::uint32_t>(view)};
  return std::mt19937_64(seeds);
}

std::vector<std::string> sensors_of_view(const Scenario& scenario, int view) {
  const auto& groups = scenario.placement.groups;
  if (!groups.empty()) return groups[static_cast<std::size_t>(view - 1) % groups.size()];
  std::vector<std::string> all;
  for (const auto& [name, camera] : scenario.cameras) all.push_back(name);
  for (const auto& [name, lidar] : scenario.lidars) all.push_back(name);
  return all;
}

}  // namespace ca2
