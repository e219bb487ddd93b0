#include "drivers/lidar/velodyne/projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ca2 {
namespace {

constexpr double centidegree = std::numbers::pi / 18000;

/// Sine and cosine of every azimuth the wire can carry.
const std::vector<std::pair<double, double>>& head_table() {
  static const std::vector<std::pair<double, double>> table = [] {
    std::vector<std::pair<double, double>> out;
    out.reserve(VelodynePacket::azimuth_turn);
    for (int i = 0; i < VelodynePacket::azimuth_turn; ++i) {
      out.emplace_back(std::sin(i * centidegree), std::cos(i * centidegree));
    }
    return out;
  }();
  return table;
}

/// Distances at which the near-point corrections were measured (HDL-64E manual), m.
constexpr double far_point = 25.04, near_point_x = 2.40, near_point_y = 1.93;

}  // namespace

void VelodyneReturns::append_to(LidarScan& out, std::uint32_t column, bool with_exact) const {
  Scan& scan = out.scan;
  const auto n = static_cast<std::ptrdiff_t>(size);
  scan.points.insert(scan.points.end(), points.begin(), points.begin() + n);
  scan.intensity.insert(scan.intensity.end(), intensity.begin(), intensity.begin() + n);
  scan.range.insert(scan.range.end(), range.begin(), range.begin() + n);
  scan.ring.insert(scan.ring.end(), ring.begin(), ring.begin() + n);
  scan.time.insert(scan.time.end(), time.begin(), time.begin() + n);
  scan.column.insert(scan.column.end(), size, column);
  if (with_exact) out.exact.insert(out.exact.end(), exact.begin(), exact.begin() + n);
}

VelodyneProjection::VelodyneProjection(const VelodyneModel& model, const VelodyneCalibration& calibration,
                                       bool two_point)
    : lsb_(model.distance_lsb), per_block_(model.firings_per_block()) {
  const std::vector<int> rings = velodyne_rings(calibration);
  for (std::size_t id = 0; id < calibration.lasers.size(); ++id) {
    const VelodyneLaser& in = calibration.lasers[id];
    Laser laser;
    laser.cos_vertical = std::cos(in.vertical);
    laser.sin_vertical = std::sin(in.vertical);
    laser.cos_rotation = std::cos(-in.rotation);
    laser.sin_rotation = std::sin(-in.rotation);
    laser.distance = in.distance;
    laser.vertical_offset = in.vertical_offset;
    laser.horizontal_offset = in.horizontal_offset;
    laser.firing = model.firing[id] / model.cycle;
    laser.focal = 256 * std::pow(1 - in.focal_distance / 131.0, 2);
    laser.focal_slope = in.focal_slope;
    laser.min_intensity = static_cast<float>(in.min_intensity);
    laser.max_intensity = static_cast<float>(in.max_intensity);
    laser.near_x = in.distance_x;
    laser.near_y = in.distance_y;
    laser.two_point = two_point && in.distance_x != 0 && in.distance_y != 0;
    laser.ring = static_cast<std::uint16_t>(rings[id]);
    lasers_.push_back(laser);
    corrected_intensity_ =
        corrected_intensity_ || in.focal_slope != 0 || in.min_intensity != 0 || in.max_intensity != 255;
  }
  firing_time_.resize(lasers_.size());
  set_cycle(model.cycle);
}

void VelodyneProjection::set_cycle(double cycle) {
  if (cycle == cycle_) return;
  cycle_ = cycle;
  for (std::size_t id = 0; id < lasers_.size(); ++id) {
    firing_time_[id] = std::llround(lasers_[id].firing * cycle * 1e9);
  }
}

const VelodyneProjection::Turn* VelodyneProjection::turns(double step, int half) {
  // Means over 11 steps: neighbouring values fall into neighbouring places.
  Motion& motion = motions_[static_cast<std::uint64_t>(std::llround(step * 11)) % motions_.size()];
  if (motion.step != step || motion.turns.empty()) {
    motion.step = step;
    motion.turns.clear();
    for (int h = 0; h < per_block_; ++h) {
      for (const Laser& laser : lasers_) {
        const double turned = step * centidegree * (h + laser.firing) / per_block_;
        const double s = std::sin(turned), c = std::cos(turned);
        motion.turns.push_back({laser.sin_rotation * c + laser.cos_rotation * s,
                                laser.cos_rotation * c - laser.sin_rotation * s});
      }
    }
  }
  return motion.turns.data() + static_cast<std::size_t>(half) * lasers_.size();
}

inline void VelodyneProjection::project_one(const Laser& laser, const Turn& turn, const Turn& head,
                                            int counts, int intensity, std::int64_t time,
                                            VelodyneReturns& out) const {
  const double measured = counts * lsb_;
  const double sine = head.sine * turn.cosine + head.cosine * turn.sine;
  const double cosine = head.cosine * turn.cosine - head.sine * turn.sine;
  const double h = laser.horizontal_offset;
  const double range = measured + laser.distance;
  double flat_x = range * laser.cos_vertical, flat_y = flat_x;
  if (laser.two_point && range < far_point) {
    const double x = std::abs(flat_x * sine - h * cosine), y = std::abs(flat_y * cosine + h * sine);
    const double dx = (laser.distance - laser.near_x) * (x - near_point_x) / (far_point - near_point_x);
    const double dy = (laser.distance - laser.near_y) * (y - near_point_y) / (far_point - near_point_y);
    flat_x = (measured + laser.near_x + dx) * laser.cos_vertical;
    flat_y = (measured + laser.near_y + dy) * laser.cos_vertical;
  }
  const std::size_t n = out.size;
  const Eigen::Vector3d point(flat_x * sine - h * cosine, flat_y * cosine + h * sine,
                              range * laser.sin_vertical + laser.vertical_offset);
  out.exact[n] = {point, range};
  out.points[n] = point.cast<float>();
  out.range[n] = static_cast<float>(range);
  out.ring[n] = laser.ring;
  out.time[n] = time;
  float value = static_cast<float>(intensity);
  if (corrected_intensity_) {
    const double far = 256 * std::pow(1 - counts / 65535.0, 2);
    value += static_cast<float>(laser.focal_slope * std::abs(laser.focal - far));
    value = std::clamp(value, laser.min_intensity, std::max(laser.min_intensity, laser.max_intensity));
  }
  out.intensity[n] = value;
  out.size = n + (counts != 0);
}

void VelodyneProjection::project(const VelodyneFiring& firing, std::int64_t time, bool second_returns,
                                 VelodyneReturns& out) {
  using P = VelodynePacket;
  const auto& [head_sine, head_cosine] = head_table()[static_cast<std::size_t>(firing.azimuth)];
  const Turn head{head_sine, head_cosine};
  const std::int64_t start = time + std::llround(firing.cycle * cycle_ * 1e9);
  const int lasers = static_cast<int>(lasers_.size());
  const int channels = std::min(lasers, P::channels);
  const int banks = (lasers + P::channels - 1) / P::channels;
  out.size = 0;
  for (int bank = 0; bank < banks; ++bank) {
    const std::uint8_t* first = firing.blocks[0][static_cast<std::size_t>(bank)];
    const std::uint8_t* second = firing.blocks[1][static_cast<std::size_t>(bank)];
    if (!first) std::swap(first, second);
    if (!first) continue;
    const Turn* turn = turns(firing.step[static_cast<std::size_t>(bank)], firing.half);
    for (int channel = 0; channel < channels; ++channel) {
      const auto id = static_cast<std::size_t>(bank * P::channels + channel);
      const int at = firing.half * lasers * (lasers < P::channels) + channel;
      const std::int64_t when = start + firing_time_[id];
      const int counts = P::distance(first, at);
      project_one(lasers_[id], turn[id], head, counts, P::intensity(first, at), when, out);
      if (!second) continue;
      // Equal blocks mean that there was one return only.
      const int other = P::distance(second, at);
      if (other != counts && (second_returns || counts == 0)) {
        project_one(lasers_[id], turn[id], head, other, P::intensity(second, at), when, out);
      }
    }
  }
}

}  // namespace ca2
