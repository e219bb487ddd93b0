#include "tools/sim/lidar_simulator.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/sim/beam_echo.h"
#include "tools/sim/placement.h"
#include "tools/sim/range_model.h"

namespace ca2 {
namespace {

class Revolution {
 public:
  Revolution(const SimulatedLidar& lidar, const Scene& scene, double azimuth)
      : lidar_(lidar), scene_(scene), beams_(lidar.beams), R_lidar_(so3_exp({0, 0, azimuth})) {
    for (std::size_t i = 0; i < scene.solids.size(); ++i) {
      if (scene.solids[i].shape == Shape::plate) plates_.push_back(static_cast<int>(i));
    }
    hits_.resize(beams_.rays.size());
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const BeamRay ray = ray_lidar(i);
      hits_[i] = scene.cast(lidar.T_rig_lidar * ray.origin, lidar.T_rig_lidar.R * ray.direction);
    }
  }

  /// The beam with the azimuth as it really was, LiDAR frame.
  BeamRay ray_lidar(std::size_t i) const {
    return {R_lidar_ * beams_.rays[i].origin, R_lidar_ * beams_.rays[i].direction};
  }

  std::optional<Echo> echo(std::size_t i) const {
    const SolidHit& hit = hits_[i];
    const BeamRay ray = ray_lidar(i);
    const Eigen::Vector3d origin = lidar_.T_rig_lidar * ray.origin;
    const Eigen::Vector3d direction = lidar_.T_rig_lidar.R * ray.direction;
    if (!near_plate(origin, direction) && !at_edge(i)) {
      if (hit.solid < 0) return std::nullopt;
      return echo_of(scene_, hit, direction);
    }
    return cone_echo(scene_, lidar_.noise, hit, origin, direction);
  }

 private:
  bool near_plate(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    return std::any_of(plates_.begin(), plates_.end(), [&](int plate) {
      return ca2::near_plate(scene_.solids[static_cast<std::size_t>(plate)], lidar_.noise, origin, direction);
    });
  }

  /// Does a neighbouring beam meet another surface, so that this one's footprint may touch it?
  bool at_edge(std::size_t i) const {
    const int ring = static_cast<int>(i) / beams_.columns, column = static_cast<int>(i) % beams_.columns;
    const int left = (column + beams_.columns - 1) % beams_.columns, right = (column + 1) % beams_.columns;
    const auto differs = [&](int r, int c) {
      return r >= 0 && r < beams_.rings &&
             hits_[static_cast<std::size_t>(r) * beams_.columns + c].surface() != hits_[i].surface();
    };
    return differs(ring, left) || differs(ring, right) || differs(ring - 1, column) ||
           differs(ring + 1, column);
  }

  const SimulatedLidar& lidar_;
  const Scene& scene_;
  const BeamTable& beams_;
  Eigen::Matrix3d R_lidar_;
  std::vector<SolidHit> hits_;
  std::vector<int> plates_;
};

}  // namespace

Scan simulate_scan(const SimulatedLidar& lidar, const Scene& scene, std::mt19937_64& rng) {
  const BeamTable& beams = lidar.beams;
  const LidarNoise& noise = lidar.noise;
  Scan scan;
  scan.rings = beams.rings;
  scan.columns = beams.columns;
  std::normal_distribution<double> normal;
  std::bernoulli_distribution lost(noise.dropout);
  for (int sweep = 0; sweep < noise.sweeps; ++sweep) {
    const Revolution revolution(lidar, scene, draw_azimuth(lidar, rng));
    for (std::size_t i = 0; i < beams.rays.size(); ++i) {
      const std::optional<Echo> echo = revolution.echo(i);
      if (!echo || lost(rng)) continue;
      const double range = measured_range(lidar, echo->range, echo->reflectivity, rng);
      const double strength = 1 + noise.intensity_sigma * normal(rng);
      if (range < beams.min_range || (beams.max_range > 0 && range > beams.max_range)) continue;
      const BeamRay ray = revolution.ray_lidar(i);
      scan.points.push_back((ray.origin + range * ray.direction).cast<float>());
      scan.range.push_back(static_cast<float>(range));
      // 2000 photons from white paper at 1 m; a calibrated reflectivity in percent.
      const double intensity = noise.free_running_azimuth ? 100 * echo->reflectivity : 2500 * echo->energy;
      scan.intensity.push_back(static_cast<float>(std::max(0.0, std::round(intensity * strength))));
      scan.ring.push_back(static_cast<std::uint16_t>(static_cast<int>(i) / beams.columns));
      scan.column.push_back(static_cast<std::uint32_t>(static_cast<int>(i) % beams.columns));
      scan.time.push_back(
          static_cast<std::int64_t>(std::llround(1e9 * (sweep / beams.rate + beams.time[i]))));
    }
  }
  return scan;
}

}  // namespace ca2
