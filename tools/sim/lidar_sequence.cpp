#include "tools/sim/lidar_sequence.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/sim/range_model.h"

namespace ca2 {
namespace {

constexpr int columns_per_slice = 8;  // of one moment: under a millisecond
constexpr int phases = 4;             // of the room's sweep, per column

/// Spheres round what moves, blown up by the widest footprint.
class MovingSpheres {
 public:
  MovingSpheres(const Scene& scene, std::size_t first) {
    for (std::size_t i = first; i < scene.solids.size(); ++i) {
      centers_.push_back(scene.solids[i].T_rig_solid.t);
      radii_.push_back(scene.solids[i].bounding_radius);
    }
  }

  bool touched(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
               const LidarNoise& noise) const {
    for (std::size_t i = 0; i < centers_.size(); ++i) {
      const Eigen::Vector3d to = centers_[i] - origin;
      const double along = to.dot(direction);
      const double reach = radii_[i] + noise.divergence * to.norm() + noise.beam_width + 0.01;
      if (along > -reach && to.squaredNorm() - along * along < reach * reach) return true;
    }
    return false;
  }

 private:
  std::vector<Eigen::Vector3d> centers_;
  std::vector<double> radii_;
};

}  // namespace

LidarSequence::LidarSequence(const SimulatedLidar& lidar, const Scene& room,
                             std::function<void(Scene&, double)> add_moving, std::uint64_t seed)
    : lidar_(lidar), room_(room), add_moving_(std::move(add_moving)), rng_(seed) {}

bool LidarSequence::at_edge(const std::vector<SolidHit>& hits, std::size_t beam) const {
  const BeamTable& beams = lidar_.beams;
  const int ring = static_cast<int>(beam) / beams.columns, column = static_cast<int>(beam) % beams.columns;
  const auto differs = [&](int r, int c) {
    return r >= 0 && r < beams.rings &&
           hits[static_cast<std::size_t>(r) * static_cast<std::size_t>(beams.columns) +
                static_cast<std::size_t>(c)]
                   .surface() != hits[beam].surface();
  };
  return differs(ring, (column + beams.columns - 1) % beams.columns) ||
         differs(ring, (column + 1) % beams.columns) || differs(ring - 1, column) ||
         differs(ring + 1, column);
}

std::optional<Echo> LidarSequence::measure(const Scene& scene, const std::vector<SolidHit>& hits,
                                           std::size_t beam, const Eigen::Vector3d& origin,
                                           const Eigen::Vector3d& direction) const {
  const bool plate = std::any_of(scene.solids.begin(), scene.solids.end(), [&](const Solid& solid) {
    return solid.shape == Shape::plate && near_plate(solid, lidar_.noise, origin, direction);
  });
  if (plate || at_edge(hits, beam)) return cone_echo(scene, lidar_.noise, hits[beam], origin, direction);
  if (hits[beam].solid < 0) return std::nullopt;
  return echo_of(scene, hits[beam], direction);
}

const std::vector<LidarSequence::StaticBeam>& LidarSequence::static_sweep(int phase) {
  if (const auto found = static_.find(phase); found != static_.end()) return found->second;
  // A free-running head drifts through few phases: the old ones are not seen again.
  if (static_.size() >= 3) static_.clear();
  const BeamTable& beams = lidar_.beams;
  const double angle = -2 * std::numbers::pi * phase / (phases * beams.columns);
  const Eigen::Matrix3d R_rig = lidar_.T_rig_lidar.R * so3_exp({0, 0, angle});
  std::vector<SolidHit> hits(beams.rays.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    hits[i] =
        room_.cast(R_rig * beams.rays[i].origin + lidar_.T_rig_lidar.t, R_rig * beams.rays[i].direction);
  }
  std::vector<StaticBeam>& sweep = static_[phase];
  sweep.resize(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    sweep[i] = {hits[i], measure(room_, hits, i, R_rig * beams.rays[i].origin + lidar_.T_rig_lidar.t,
                                 R_rig * beams.rays[i].direction)};
  }
  return sweep;
}

EncoderScan LidarSequence::scan(double start, double azimuth) {
  const BeamTable& beams = lidar_.beams;
  const auto columns = static_cast<std::size_t>(beams.columns);
  const double turn = azimuth - std::floor(azimuth);
  const auto& sweep = static_sweep(static_cast<int>(std::lround(turn * phases * beams.columns)));
  // Azimuth runs clockwise, rotations about z counter-clockwise.
  const Eigen::Matrix3d R_rig = lidar_.T_rig_lidar.R * so3_exp({0, 0, -2 * std::numbers::pi * turn});

  std::vector<SolidHit> hits(sweep.size());
  std::vector<char> moving(sweep.size(), 0);
  for (std::size_t i = 0; i < sweep.size(); ++i) hits[i] = sweep[i].hit;
  std::vector<Scene> scenes;
  const auto first_moving = static_cast<int>(room_.solids.size());
  const auto ray = [&](std::size_t i, Eigen::Vector3d& origin, Eigen::Vector3d& direction) {
    origin = R_rig * beams.rays[i].origin + lidar_.T_rig_lidar.t;
    direction = R_rig * beams.rays[i].direction;
  };
  Eigen::Vector3d origin, direction;
  for (int first = 0; first < beams.columns; first += columns_per_slice) {
    const int last = std::min(first + columns_per_slice, beams.columns);
    Scene& scene = scenes.emplace_back(room_);
    add_moving_(scene, start + beams.time[static_cast<std::size_t>((first + last) / 2)]);
    const MovingSpheres spheres(scene, static_cast<std::size_t>(first_moving));
    std::vector<int> indices;
    for (int s = first_moving; s < static_cast<int>(scene.solids.size()); ++s) indices.push_back(s);
    for (int ring = 0; ring < beams.rings; ++ring) {
      for (int column = first; column < last; ++column) {
        const std::size_t i = static_cast<std::size_t>(ring) * columns + static_cast<std::size_t>(column);
        ray(i, origin, direction);
        if (!spheres.touched(origin, direction, lidar_.noise)) continue;
        moving[i] = 1;
        const SolidHit hit = scene.cast(origin, direction, indices);
        if (hit.solid >= 0 && (hits[i].solid < 0 || hit.distance < hits[i].distance)) hits[i] = hit;
      }
    }
  }

  EncoderScan out;
  out.rings = beams.rings;
  out.columns = beams.columns;
  out.azimuth = turn;
  out.range[0].assign(sweep.size(), 0.0f);
  out.reflectivity[0].assign(sweep.size(), 0.0f);
  std::bernoulli_distribution lost(lidar_.noise.dropout);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    std::optional<Echo> echo = sweep[i].echo;
    if (moving[i]) {
      ray(i, origin, direction);
      echo = measure(scenes[i % columns / columns_per_slice], hits, i, origin, direction);
    }
    if (!echo || lost(rng_)) continue;
    const double range = measured_range(lidar_, echo->range, echo->reflectivity, rng_);
    if (range < beams.min_range || (beams.max_range > 0 && range > beams.max_range)) continue;
    out.range[0][i] = static_cast<float>(range);
    const double strength = 1 + lidar_.noise.intensity_sigma * normal(rng_);
    out.reflectivity[0][i] = static_cast<float>(std::clamp(100 * echo->reflectivity * strength, 1.0, 255.0));
  }
  return out;
}

}  // namespace ca2
