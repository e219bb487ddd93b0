#include "tools/sim/rim_simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tools/sim/placement.h"

namespace ca2 {

double beam_height(const BeamTable& beams, int ring) {
  const BeamRay& ray = beams.ray(ring, 0);
  const double along =
      -ray.origin.head<2>().dot(ray.direction.head<2>()) / ray.direction.head<2>().squaredNorm();
  return ray.origin.z() + along * ray.direction.z();
}

RimSimulator::RimSimulator(const SimulatedLidar& lidar, const Pose& T_lidar_board, const Plate& plate)
    : lidar_(lidar),
      T_lidar_board_(T_lidar_board),
      plate_(plate),
      around_(plate),
      rings_(static_cast<std::size_t>(lidar.beams.rings)) {
  const Eigen::Vector3d& center = T_lidar_board.t;
  azimuth_ = std::atan2(center.y(), center.x());
  for (int ring = 0; ring < lidar.beams.rings; ++ring) heights_.push_back(beam_height(lidar.beams, ring));
  // Wide enough for the next ring of a sensor with few of them.
  const double beside = std::max(0.1, 0.08 * center.norm());
  around_.outline.width += 2 * beside;
  around_.outline.height += 2 * beside;
}

bool RimSimulator::answers(const BeamRay& ray) const {
  const double w = 0.5 * plate_.outline.width, h = 0.5 * plate_.outline.height;
  const Eigen::Vector2d corners[]{{w, h}, {w, -h}, {-w, -h}, {-w, h}};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto end = [&](const Eigen::Vector2d& corner) {
      const Eigen::Vector2d p = plate_.outline.center + corner;
      return Eigen::Vector3d(T_lidar_board_ * Eigen::Vector3d(p.x(), p.y(), plate_.height(p)) - ray.origin);
    };
    const Eigen::Vector3d a = end(corners[i]), b = end(corners[(i + 1) % 4]);
    const double width = lidar_.noise.divergence + lidar_.noise.beam_width / (0.5 * (a + b)).norm();
    if (a.cross(b).normalized().dot(ray.direction) > std::sin(dilation_per_width * width)) return false;
  }
  return true;
}

void RimSimulator::add_revolution(double azimuth, std::mt19937_64& rng) {
  std::bernoulli_distribution lost(lidar_.noise.dropout);
  for (const PlateHit& hit : cast_on_plate(lidar_.beams, azimuth, T_lidar_board_, around_)) {
    if (lost(rng)) continue;
    const auto ring = static_cast<std::size_t>(hit.ring);
    const Eigen::Vector3d p = hit.ray.origin + (hit.range + lidar_.noise.range_bias) * hit.ray.direction;
    rings_[ring].push_back({std::remainder(std::atan2(p.y(), p.x()) - azimuth_, 2 * std::numbers::pi),
                            (p - Eigen::Vector3d(0, 0, heights_[ring])).normalized(), answers(hit.ray)});
  }
}

void RimSimulator::add_ends(std::size_t ring, std::vector<EdgeCrossing>& crossings) const {
  const std::vector<Look>& looks = rings_[ring];
  for (const int way : {-1, 1}) {
    const Look* inside = nullptr;
    for (const Look& look : looks) {
      if (look.on_plate && (!inside || way * (look.azimuth - inside->azimuth) > 0)) inside = &look;
    }
    if (!inside) continue;
    // The next look that was not lost; where there is none near, a column further.
    const double step = 2 * std::numbers::pi / lidar_.beams.columns;
    double gap = std::numeric_limits<double>::infinity();
    for (const Look& look : looks) {
      const double away = way * (look.azimuth - inside->azimuth);
      if (!look.on_plate && away > 1e-6) gap = std::min(gap, away);
    }
    if (gap > 3 * step) gap = step;
    const Eigen::AngleAxisd turn(way * gap, Eigen::Vector3d::UnitZ());
    crossings.push_back({inside->direction.cast<float>(), (turn * inside->direction).cast<float>(),
                         std::numeric_limits<float>::infinity(), static_cast<std::uint16_t>(ring), false,
                         static_cast<float>(heights_[ring]), static_cast<float>(heights_[ring])});
  }
}

void RimSimulator::add_between(std::size_t last, std::size_t beyond,
                               std::vector<EdgeCrossing>& crossings) const {
  for (const Look& inside : rings_[last]) {
    if (!inside.on_plate) continue;
    const Look* nearest = nullptr;
    for (const Look& look : rings_[beyond]) {
      if (!nearest || std::abs(look.azimuth - inside.azimuth) < std::abs(nearest->azimuth - inside.azimuth))
        nearest = &look;
    }
    if (!nearest) return;
    crossings.push_back({inside.direction.cast<float>(), nearest->direction.cast<float>(),
                         std::numeric_limits<float>::infinity(), static_cast<std::uint16_t>(last), true,
                         static_cast<float>(heights_[last]), static_cast<float>(heights_[beyond])});
  }
}

std::vector<EdgeCrossing> RimSimulator::crossings() const {
  std::vector<EdgeCrossing> list;
  std::vector<std::pair<double, std::size_t>> by_elevation;
  for (std::size_t ring = 0; ring < rings_.size(); ++ring) {
    add_ends(ring, list);
    double elevation = 0;
    for (const Look& look : rings_[ring])
      elevation += look.direction.z() / static_cast<double>(rings_[ring].size());
    if (!rings_[ring].empty()) by_elevation.emplace_back(elevation, ring);
  }
  std::sort(by_elevation.begin(), by_elevation.end());
  const auto on_plate = [&](const std::pair<double, std::size_t>& entry) {
    const std::vector<Look>& looks = rings_[entry.second];
    return std::any_of(looks.begin(), looks.end(), [](const Look& look) { return look.on_plate; });
  };
  const auto first = std::find_if(by_elevation.begin(), by_elevation.end(), on_plate);
  if (first == by_elevation.end()) return list;
  auto last = by_elevation.end() - 1;
  while (!on_plate(*last)) --last;
  if (first != by_elevation.begin()) add_between(first->second, (first - 1)->second, list);
  if (last + 1 != by_elevation.end()) add_between(last->second, (last + 1)->second, list);
  return list;
}

}  // namespace ca2
