#include "tools/sim/feature_sights.h"

#include <algorithm>
#include <cstdint>

#include "core/geometry/plane.h"

namespace ca2 {

Rig rig_of(const Scenario& scenario) {
  Rig rig;
  rig.board = scenario.board;
  for (const auto& [name, sensor] : scenario.cameras) {
    RigCamera& camera = rig.cameras[name];
    camera.frame = name;
    camera.width = sensor.camera.width;
    camera.height = sensor.camera.height;
    camera.intrinsics = sensor.camera;
  }
  for (const auto& [name, sensor] : scenario.lidars) rig.lidars[name].frame = name;
  return rig;
}

Result<std::vector<ViewSights>> sights_of(const Rig& rig, const std::vector<SimulatedView>& views) {
  std::vector<ViewSights> all;
  for (const SimulatedView& view : views) {
    ViewSights& sights = all.emplace_back();
    sights.id = static_cast<int>(all.size());
    for (const auto& [name, camera] : rig.cameras) {
      std::optional<CameraSight>& sight = sights.cameras.emplace_back();
      const auto corners = view.corners.find(name);
      if (corners == view.corners.end() || corners->second.size() < 4) continue;
      Result<BoardPose> pose = estimate_board_pose(rig.board, *camera.intrinsics, corners->second);
      if (!pose) return fail(pose.error());
      sight = CameraSight{corners->second, *pose};
    }
    for (const auto& [name, lidar] : rig.lidars) {
      std::vector<LidarSight>& hypotheses = sights.lidars.emplace_back();
      const auto scan = view.board_returns.find(name);
      if (scan == view.board_returns.end() || scan->second.size() < 4) continue;
      std::vector<Eigen::Vector3d> points;
      LidarSight& sight = hypotheses.emplace_back();
      for (const Eigen::Vector3f& p : scan->second.points) points.push_back(p.cast<double>());
      sight.plane = fit_plane(points, &sight.rms);
      sight.center.setZero();
      for (const Eigen::Vector3d& p : points) sight.center += p / static_cast<double>(points.size());
      for (std::size_t i = 0; i < scan->second.size(); ++i) {
        // 100 is white that sends everything back.
        const auto intensity =
            static_cast<std::uint16_t>(600 * std::clamp(scan->second.intensity[i], 0.f, 100.f));
        sight.on_board.push_back(
            {scan->second.points[i], scan->second.ring[i], intensity, view.heights.at(name)[i]});
      }
      if (const auto rim = view.crossings.find(name); rim != view.crossings.end() && rig.board.outline)
        sight.crossings = rim->second;
      sight.score = 1;
    }
  }
  return all;
}

std::vector<ViewSights> without_crossings(std::vector<ViewSights> views) {
  for (ViewSights& view : views) {
    for (auto& hypotheses : view.lidars) {
      for (LidarSight& sight : hypotheses) sight.crossings.clear();
    }
  }
  return views;
}

}  // namespace ca2
