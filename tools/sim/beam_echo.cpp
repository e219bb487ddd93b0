#include "tools/sim/beam_echo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/sim/range_model.h"

namespace ca2 {
namespace {

/// Directions across a beam's cone in units of its half angle, of equal share and even all over it: pairs
/// about the axis, each further round by the golden angle. A few would move a rim from one to the next.
constexpr int footprint_samples = 48;
std::array<Eigen::Vector2d, footprint_samples> footprint() {
  std::array<Eigen::Vector2d, footprint_samples> samples;
  constexpr int pairs = footprint_samples / 2;
  for (int k = 0; k < pairs; ++k) {
    const double radius = std::sqrt((k + 0.5) / pairs),
                 angle = k * std::numbers::pi * (std::sqrt(5.0) - 1) / 2;
    const auto i = static_cast<std::size_t>(2 * k);
    samples[i] = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    samples[i + 1] = -samples[i];
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

}  // namespace

Echo echo_of(const Scene& scene, const SolidHit& hit, const Eigen::Vector3d& direction) {
  const Solid& solid = scene.solids[static_cast<std::size_t>(hit.solid)];
  const double reflectivity = solid.print
                                  ? print_reflectivity(*solid.print, hit.point.head<2>())
                                  : std::clamp(solid.material.reflectivity * scene.texture(hit), 0.02, 0.95);
  const double cosine = std::abs(scene.normal(hit, direction).dot(direction));
  return {hit.distance, reflectivity, reflectivity * cosine / (hit.distance * hit.distance)};
}

bool near_plate(const Solid& plate, const LidarNoise& noise, const Eigen::Vector3d& origin,
                const Eigen::Vector3d& direction) {
  const Eigen::Vector3d o = plate.T_rig_solid.R.transpose() * (origin - plate.T_rig_solid.t);
  const Eigen::Vector3d d = plate.T_rig_solid.R.transpose() * direction;
  const auto t = plate.plate.meet(o, d);
  if (!t || *t <= 0) return false;
  const double footprint_radius =
      (*t * noise.divergence + noise.beam_width) / 2 / std::max(0.05, std::abs(d.z()));
  return plate.plate.contains((o + *t * d).head<2>(), -footprint_radius);
}

std::optional<Echo> cone_echo(const Scene& scene, const LidarNoise& noise, const SolidHit& axis,
                              const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  std::array<Echo, footprint_samples> echoes;
  std::size_t count = 0;
  bool one_surface = true;
  const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
  static const auto samples = footprint();
  for (const Eigen::Vector2d& sample : samples) {
    const Eigen::Vector3d across = 0.5 * (sample.x() * u + sample.y() * v);
    const Eigen::Vector3d part = (direction + noise.divergence * across).normalized();
    const SolidHit part_hit = scene.cast(origin + noise.beam_width * across, part);
    if (part_hit.solid >= 0) echoes[count++] = echo_of(scene, part_hit, part);
    one_surface = one_surface && part_hit.surface() == axis.surface();
  }
  if (count == 0) return std::nullopt;
  Echo echo = strongest_return(echoes, count, noise.pulse_length);
  // On one surface the axis of the cone stands for it: a noise-free return lies on the plate.
  if (one_surface) echo.range = axis.distance;
  return echo;
}

}  // namespace ca2
