#include "tools/sim/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace ca2 {
namespace {

constexpr int max_tries = 20000;
// A LiDAR or camera that sees the board more obliquely than this sees nothing useful.
constexpr double min_facing_cosine = 0.25;

double uniform(std::mt19937_64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

bool faces(const Pose& T_sensor_board) {
  return T_sensor_board.R.col(2).dot(T_sensor_board.t) > min_facing_cosine * T_sensor_board.t.norm();
}

bool seen(const SimulatedCamera& sensor, const Board& board, const Pose& T_camera_board, double margin) {
  if (!faces(T_camera_board)) return false;
  const std::vector<Eigen::Vector2d> corners = board.type->corners(board);
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
    const auto pixel = sensor.camera.project(T_camera_board * Eigen::Vector3d(corner.x(), corner.y(), 0));
    return pixel && sensor.camera.contains(*pixel, margin);
  });
}

bool seen(const SimulatedLidar& sensor, const Plate& plate, const Pose& T_lidar_board,
          const Placement& placement) {
  if (!faces(T_lidar_board)) return false;
  const std::vector<PlateHit> hits = cast_on_plate(sensor.beams, 0, T_lidar_board, plate);
  if (static_cast<int>(hits.size()) < placement.min_returns) return false;
  std::set<int> rings;
  for (const PlateHit& hit : hits) rings.insert(hit.ring);
  return static_cast<int>(rings.size()) >= placement.min_rings;
}

/// Is the whole plate inside the room, off the floor and with space for the person behind it?
bool inside(const Room& room, const Plate& plate, const Pose& T_rig_board) {
  constexpr double wall_gap = 0.8, floor_gap = 0.25, ceiling_gap = 0.25;  // m
  for (const double sx : {-0.5, 0.5}) {
    for (const double sy : {-0.5, 0.5}) {
      const Eigen::Vector2d corner =
          plate.outline.center + Eigen::Vector2d(sx * plate.outline.width, sy * plate.outline.height);
      const Eigen::Vector3d p = T_rig_board * Eigen::Vector3d(corner.x(), corner.y(), 0);
      if (std::abs(p.x()) > room.length / 2 - wall_gap || std::abs(p.y()) > room.width / 2 - wall_gap) {
        return false;
      }
      if (p.z() < -room.rig_height + floor_gap || p.z() > room.height - room.rig_height - ceiling_gap) {
        return false;
      }
    }
  }
  return true;
}

/// The pose of a viewer (x right, y down, z along the line of sight) in the rig frame.
Pose look_along(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                const Eigen::Vector3d& down) {
  Pose T_rig_viewer;
  T_rig_viewer.R.col(2) = direction;
  T_rig_viewer.R.col(1) = (down - down.dot(direction) * direction).normalized();
  T_rig_viewer.R.col(0) = T_rig_viewer.R.col(1).cross(T_rig_viewer.R.col(2));
  T_rig_viewer.t = origin;
  return T_rig_viewer;
}

/// Somebody at the sensor who looks in a random direction of its field of view.
Pose draw_viewer(const Scenario& scenario, const std::string& sensor, std::mt19937_64& rng) {
  if (const auto found = scenario.cameras.find(sensor); found != scenario.cameras.end()) {
    const auto& [camera, T_rig_camera, noise] = found->second;
    for (;;) {
      const double u = uniform(rng, 0, camera.width - 1);
      const double v = uniform(rng, 0, camera.height - 1);
      const auto direction = camera.unproject({u, v});
      // A wide fisheye looks almost past its own plane: nobody holds a board there.
      if (!direction || direction->z() < 0.1) continue;
      return look_along(T_rig_camera.t, T_rig_camera.R * *direction, T_rig_camera.R.col(1));
    }
  }
  const SimulatedLidar& lidar = scenario.lidars.at(sensor);
  std::uniform_int_distribution<std::size_t> index(0, lidar.beams.rays.size() - 1);
  return look_along(lidar.T_rig_lidar.t, lidar.T_rig_lidar.R * lidar.beams.rays[index(rng)].direction,
                    -lidar.T_rig_lidar.R.col(2));
}

}  // namespace

std::vector<PlateHit> cast_on_plate(const BeamTable& beams, double azimuth, const Pose& T_lidar_board,
                                    const Plate& plate) {
  std::vector<PlateHit> hits;
  const Eigen::Vector3d center =
      T_lidar_board * Eigen::Vector3d(plate.outline.center.x(), plate.outline.center.y(), 0);
  const double distance = center.norm();
  // Only beams in the cone round the plate are cast; they begin up to a few centimetres off the origin.
  constexpr double origin_allowance = 0.3;  // m
  const double radius =
      std::hypot(plate.outline.width, plate.outline.height) / 2 + std::abs(plate.bend) + origin_allowance;
  const double cone = radius < distance ? std::asin(radius / distance) : std::numbers::pi;
  // A ring's beams are one beam turned about z by a column's step: where one is far outside the cone, so are
  // those that follow it.
  constexpr int stride = 16;
  const double far_cone = cone + stride * 2 * std::numbers::pi / std::max(beams.columns, 1);
  const double cosine = std::cos(cone);
  const double far_cosine = far_cone < std::numbers::pi ? std::cos(far_cone) : -1;
  const Eigen::Matrix3d turn = so3_exp({0, 0, azimuth});
  const Eigen::Vector3d axis = turn.transpose() * center / std::max(distance, 1e-9);
  const Pose T_board_lidar = T_lidar_board.inverse();
  const auto cast = [&](int ring, int column) {
    const BeamRay& beam = beams.ray(ring, column);
    if (beam.direction.dot(axis) < cosine) return;
    const BeamRay ray{turn * beam.origin, turn * beam.direction};
    const Eigen::Vector3d origin = T_board_lidar * ray.origin;
    const Eigen::Vector3d direction = T_board_lidar.R * ray.direction;
    const auto range = plate.intersect(origin, direction);
    if (!range || *range < beams.min_range || (beams.max_range > 0 && *range > beams.max_range)) return;
    hits.push_back({ring, column, ray, *range, (origin + *range * direction).head<2>()});
  };
  for (int ring = 0; ring < beams.rings; ++ring) {
    for (int first = 0; first < beams.columns; first += stride) {
      if (beams.ray(ring, first).direction.dot(axis) < far_cosine) continue;
      for (int column = first; column < std::min(first + stride, beams.columns); ++column) cast(ring, column);
    }
  }
  return hits;
}

double draw_azimuth(const SimulatedLidar& lidar, std::mt19937_64& rng) {
  if (!lidar.noise.free_running_azimuth) return 0;
  const double step = 2 * std::numbers::pi / std::max(lidar.beams.columns, 1);
  return uniform(rng, -step / 2, step / 2);
}

Result<Pose> place_board(const Scenario& scenario, const std::vector<std::string>& sensors,
                         std::mt19937_64& rng) {
  const Placement& placement = scenario.placement;
  const Plate plate{scenario.board.extent(), scenario.bend};
  for (int i = 0; i < max_tries; ++i) {
    const Pose T_rig_viewer = draw_viewer(scenario, sensors.front(), rng);
    const double distance = uniform(rng, placement.min_distance, placement.max_distance);
    const double tilt = uniform(rng, placement.min_tilt, placement.max_tilt);
    const double axis = uniform(rng, -std::numbers::pi, std::numbers::pi);
    const double roll = uniform(rng, -placement.max_roll, placement.max_roll);
    const Pose T_viewer_board{
        so3_exp({tilt * std::cos(axis), tilt * std::sin(axis), 0}) * so3_exp({0, 0, roll}), {0, 0, distance}};
    const Pose T_rig_board = T_rig_viewer * T_viewer_board;
    if (scenario.room && !inside(*scenario.room, plate, T_rig_board)) continue;
    const bool all_see = std::all_of(sensors.begin(), sensors.end(), [&](const std::string& name) {
      const Pose T_sensor_board = scenario.T_rig_sensor(name).inverse() * T_rig_board;
      const auto camera = scenario.cameras.find(name);
      return camera != scenario.cameras.end()
                 ? seen(camera->second, scenario.board, T_sensor_board, placement.pixel_margin)
                 : seen(scenario.lidars.at(name), plate, T_sensor_board, placement);
    });
    if (all_see) return T_rig_board;
  }
  return fail(ErrorCode::config, scenario.name, "no place for the board found that all sensors of a view see",
              "check the true extrinsics, the distances and the groups of sensors");
}

}  // namespace ca2
