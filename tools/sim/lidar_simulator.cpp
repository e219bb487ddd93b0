#include "tools/sim/lidar_simulator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "tools/sim/placement.h"
#include "tools/sim/range_model.h"

namespace ca2 {
namespace {

/// A part of a beam's footprint.
struct Echo {
  double range = 0;         ///< m
  double reflectivity = 0;  ///< diffuse
  double energy = 0;        ///< what comes back, relative to white at 1 m seen square on
};

Echo echo_of(const Scene& scene, const SolidHit& hit, const Eigen::Vector3d& direction) {
  const Solid& solid = scene.solids[static_cast<std::size_t>(hit.solid)];
  const double reflectivity = solid.print
                                  ? print_reflectivity(*solid.print, hit.point.head<2>())
                                  : std::clamp(solid.material.reflectivity * scene.texture(hit), 0.02, 0.95);
  const double cosine = std::abs(scene.normal(hit, direction).dot(direction));
  return {hit.distance, reflectivity, reflectivity * cosine / (hit.distance * hit.distance)};
}

/// Directions across a beam's cone in units of its half angle: two hexagons round the axis, of equal share.
constexpr int footprint_samples = 13;
std::array<Eigen::Vector2d, footprint_samples> footprint() {
  std::array<Eigen::Vector2d, footprint_samples> samples;
  samples[0].setZero();
  for (int k = 0; k < 6; ++k) {
    const double inner = k * std::numbers::pi / 3, outer = inner + std::numbers::pi / 6;
    samples[static_cast<std::size_t>(1 + k)] = 0.48 * Eigen::Vector2d(std::cos(inner), std::sin(inner));
    samples[static_cast<std::size_t>(7 + k)] = 0.86 * Eigen::Vector2d(std::cos(outer), std::sin(outer));
  }
  return samples;
}

/// The return a receiver makes of the echoes: they are sorted by range and cut where the gap exceeds the
/// pulse; the strongest group answers with its mean, weighted by energy.
Echo strongest_return(std::array<Echo, footprint_samples>& echoes, std::size_t count, double pulse_length) {
  const auto end = echoes.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(echoes.begin(), end, [](const Echo& a, const Echo& b) { return a.range < b.range; });
  Echo best, group;
  double first = 0;
  const auto close = [&] {
    if (group.energy > best.energy) best = group;
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (i == 0 || echoes[i].range - first > pulse_length) {
      close();
      group = {};
      first = echoes[i].range;
    }
    group.range += echoes[i].energy * echoes[i].range;
    group.reflectivity += echoes[i].energy * echoes[i].reflectivity;
    group.energy += echoes[i].energy;
  }
  close();
  best.range /= best.energy;
  best.reflectivity /= best.energy;
  best.energy /= footprint_samples;
  return best;
}

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
    std::array<Echo, footprint_samples> echoes;
    std::size_t count = 0;
    bool one_surface = true;
    const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
    static const auto samples = footprint();
    for (const Eigen::Vector2d& sample : samples) {
      const Eigen::Vector2d offset = lidar_.noise.divergence / 2 * sample;
      const Eigen::Vector3d part = (direction + offset.x() * u + offset.y() * v).normalized();
      const SolidHit part_hit = scene_.cast(origin, part);
      if (part_hit.solid >= 0) echoes[count++] = echo_of(scene_, part_hit, part);
      one_surface = one_surface && part_hit.surface() == hit.surface();
    }
    if (count == 0) return std::nullopt;
    Echo echo = strongest_return(echoes, count, lidar_.noise.pulse_length);
    // On one surface the axis of the cone stands for it: a noise-free return lies on the plate.
    if (one_surface) echo.range = hit.distance;
    return echo;
  }

 private:
  /// Can the footprint touch a plate? Asked beside the neighbours, as rings next to each other in elevation
  /// may look into different azimuths (HDL-64E).
  bool near_plate(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    for (const int index : plates_) {
      const Solid& plate = scene_.solids[static_cast<std::size_t>(index)];
      const Eigen::Vector3d o = plate.T_rig_solid.R.transpose() * (origin - plate.T_rig_solid.t);
      const Eigen::Vector3d d = plate.T_rig_solid.R.transpose() * direction;
      const auto t = plate.plate.meet(o, d);
      if (!t || *t <= 0) continue;
      const double footprint_radius = *t * lidar_.noise.divergence / 2 / std::max(0.05, std::abs(d.z()));
      if (plate.plate.contains((o + *t * d).head<2>(), -footprint_radius)) return true;
    }
    return false;
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
