#include "tools/sim/feature_simulator.h"

#include <algorithm>
#include <utility>

#include "tools/sim/placement.h"
#include "tools/sim/range_model.h"
#include "tools/sim/rim_simulator.h"

namespace ca2 {
namespace {

std::vector<Corner> observe(const SimulatedCamera& sensor, const Scenario& scenario,
                            const Pose& T_camera_board, std::mt19937_64& rng) {
  const Plate plate{scenario.board.extent(), scenario.bend};
  const double sigma = sensor.noise.corner_sigma;
  std::normal_distribution<double> normal;
  std::vector<Corner> corners;
  int id = 0;
  for (const Eigen::Vector2d& p : scenario.board.type->corners(scenario.board)) {
    const auto pixel = sensor.camera.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), plate.height(p)));
    const double du = normal(rng);
    const double dv = normal(rng);
    if (pixel && sensor.camera.contains(*pixel)) {
      // A zero covariance would be no weight: noise-free corners are weighted as if good to 1e-6 px.
      const double variance = std::max(sigma * sigma, 1e-12);
      corners.push_back(
          {id, *pixel + sigma * Eigen::Vector2d(du, dv), variance * Eigen::Matrix2d::Identity()});
    }
    ++id;
  }
  return corners;
}

void observe(const SimulatedLidar& sensor, const Scenario& scenario, const Pose& T_lidar_board,
             std::mt19937_64& rng, Scan& scan, std::vector<BeamRay>& rays, std::vector<float>& heights,
             std::vector<EdgeCrossing>& crossings) {
  const Plate plate{scenario.board.extent(), scenario.bend};
  RimSimulator rim(sensor, T_lidar_board, plate);
  scan.rings = sensor.beams.rings;
  scan.columns = sensor.beams.columns;
  for (int sweep = 0; sweep < sensor.noise.sweeps; ++sweep) {
    const double azimuth = draw_azimuth(sensor, rng);
    for (const PlateHit& hit : cast_on_plate(sensor.beams, azimuth, T_lidar_board, plate)) {
      const double reflectivity = print_reflectivity(scenario.board, hit.p_board);
      const double range = measured_range(sensor, hit.range, reflectivity, rng);
      if (std::bernoulli_distribution(sensor.noise.dropout)(rng)) continue;
      scan.points.push_back((hit.ray.origin + range * hit.ray.direction).cast<float>());
      scan.range.push_back(static_cast<float>(range));
      scan.intensity.push_back(static_cast<float>(100 * reflectivity));
      scan.ring.push_back(static_cast<std::uint16_t>(hit.ring));
      scan.column.push_back(static_cast<std::uint32_t>(hit.column));
      rays.push_back(hit.ray);
      heights.push_back(static_cast<float>(beam_height(sensor.beams, hit.ring)));
    }
    rim.add_revolution(azimuth, rng);
  }
  crossings = rim.crossings();
}

/// The cameras see the board at one place, the LiDARs at another (the same, unless the view is to lie).
SimulatedView observe_both(const Scenario& scenario, const std::vector<std::string>& sensors,
                           const Pose& T_rig_board, const Pose& T_rig_scanned, std::mt19937_64& rng) {
  SimulatedView view;
  for (const std::string& name : sensors) {
    const Pose T_sensor_rig = scenario.T_rig_sensor(name).inverse();
    view.T_sensor_board[name] = T_sensor_rig * T_rig_board;
    if (const auto camera = scenario.cameras.find(name); camera != scenario.cameras.end()) {
      view.corners[name] = observe(camera->second, scenario, view.T_sensor_board[name], rng);
    } else {
      observe(scenario.lidars.at(name), scenario, T_sensor_rig * T_rig_scanned, rng, view.board_returns[name],
              view.rays[name], view.heights[name], view.crossings[name]);
    }
  }
  return view;
}

}  // namespace

SimulatedView observe_features(const Scenario& scenario, const Pose& T_rig_board, std::mt19937_64& rng) {
  std::vector<std::string> sensors;
  for (const auto& [name, camera] : scenario.cameras) sensors.push_back(name);
  for (const auto& [name, lidar] : scenario.lidars) sensors.push_back(name);
  return observe_both(scenario, sensors, T_rig_board, T_rig_board, rng);
}

Result<SimulatedView> simulate_features(const Scenario& scenario, std::mt19937_64& rng, int view) {
  const std::vector<std::string> sensors = sensors_of_view(scenario, view);
  const bool wrong = std::bernoulli_distribution(scenario.wrong_fraction)(rng);
  const Result<Pose> T_rig_board = place_board(scenario, sensors, rng);
  if (!T_rig_board) return fail(T_rig_board.error());
  if (!wrong) return observe_both(scenario, sensors, *T_rig_board, *T_rig_board, rng);
  const Result<Pose> T_rig_other = place_board(scenario, sensors, rng);
  if (!T_rig_other) return fail(T_rig_other.error());
  SimulatedView lie = observe_both(scenario, sensors, *T_rig_board, *T_rig_other, rng);
  lie.wrong_object = scenario.wrong_object;
  return lie;
}

Result<std::vector<SimulatedView>> simulate_feature_views(const Scenario& scenario) {
  std::vector<SimulatedView> views;
  for (int id = 1; id <= scenario.views; ++id) {
    std::mt19937_64 rng = view_generator(scenario, id);
    Result<SimulatedView> view = simulate_features(scenario, rng, id);
    if (!view) return fail(view.error());
    views.push_back(std::move(*view));
  }
  return views;
}

void change_lidar_frame(SimulatedView& view, const std::string& lidar, const Pose& T_new_old) {
  for (Eigen::Vector3f& p : view.board_returns.at(lidar).points) {
    p = (T_new_old * p.cast<double>()).cast<float>();
  }
  for (BeamRay& ray : view.rays.at(lidar)) {
    ray = {T_new_old * ray.origin, T_new_old.R * ray.direction};
  }
  std::fill(view.heights.at(lidar).begin(), view.heights.at(lidar).end(), 0.f);
  // Rims are seen from the new origin where the board has them.
  const Plane plane = board_plane(view.T_sensor_board.at(lidar));
  const auto seen_anew = [&](const Eigen::Vector3f& ray, float& height) {
    const Eigen::Vector3d origin(0, 0, height), along = ray.cast<double>();
    height = 0;
    const Eigen::Vector3d p = origin - plane.distance(origin) / plane.normal.dot(along) * along;
    return Eigen::Vector3f((T_new_old * p).normalized().cast<float>());
  };
  for (EdgeCrossing& crossing : view.crossings.at(lidar)) {
    crossing.inside = seen_anew(crossing.inside, crossing.inside_height);
    crossing.outside = seen_anew(crossing.outside, crossing.outside_height);
  }
  view.T_sensor_board.at(lidar) = T_new_old * view.T_sensor_board.at(lidar);
}

}  // namespace ca2
