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

void VelodyneReturns::append_to(LidarScan& out, bool with_exact) {
  Scan& scan = out.scan;
  const auto n = static_cast<std::ptrdiff_t>(size);
  scan.points.insert(scan.points.end(), points.begin(), points.begin() + n);
  scan.intensity.insert(scan.intensity.end(), intensity.begin(), intensity.begin() + n);
  scan.range.insert(scan.range.end(), range.begin(), range.begin() + n);
  scan.ring.insert(scan.ring.end(), ring.begin(), ring.begin() + n);
  scan.time.insert(scan.time.end(), time.begin(), time.begin() + n);
  scan.column.insert(scan.column.end(), column.begin(), column.begin() + n);
  if (with_exact) out.exact.insert(out.exact.end(), exact.begin(), exact.begin() + n);
  size = 0;
}

VelodyneProjection::VelodyneProjection(const VelodyneModel& model, const VelodyneCalibration& calibration,
                                       bool two_point)
    : lsb_(model.distance_lsb), per_block_(model.firings_per_block()) {
  const auto n = static_cast<Eigen::Index>(calibration.lasers.size());
  for (Eigen::ArrayXd* field : {&cos_vertical_, &sin_vertical_, &cos_rotation_, &sin_rotation_, &distance_,
                                &vertical_offset_, &horizontal_offset_, &near_x_, &near_y_, &firing_, &focal_,
                                &focal_slope_, &min_intensity_, &max_intensity_}) {
    field->resize(n);
  }
  for (Eigen::Index id = 0; id < n; ++id) {
    const VelodyneLaser& in = calibration.lasers[static_cast<std::size_t>(id)];
    cos_vertical_[id] = std::cos(in.vertical);
    sin_vertical_[id] = std::sin(in.vertical);
    cos_rotation_[id] = std::cos(-in.rotation);
    sin_rotation_[id] = std::sin(-in.rotation);
    distance_[id] = in.distance;
    vertical_offset_[id] = in.vertical_offset;
    horizontal_offset_[id] = in.horizontal_offset;
    near_x_[id] = in.distance_x;
    near_y_[id] = in.distance_y;
    firing_[id] = model.firing[static_cast<std::size_t>(id)] / model.cycle;
    focal_[id] = 256 * std::pow(1 - in.focal_distance / 131.0, 2);
    focal_slope_[id] = in.focal_slope;
    min_intensity_[id] = in.min_intensity;
    max_intensity_[id] = std::max(in.min_intensity, in.max_intensity);
    sideways_ = sideways_ || in.horizontal_offset != 0;
    two_point_ = two_point_ || (two_point && in.distance_x != 0 && in.distance_y != 0);
    corrected_intensity_ =
        corrected_intensity_ || in.focal_slope != 0 || in.min_intensity != 0 || in.max_intensity != 255;
  }
  for (const int ring : velodyne_rings(calibration)) ring_.push_back(static_cast<std::uint16_t>(ring));
  firing_time_.resize(ring_.size());
  set_cycle(model.cycle);
}

void VelodyneProjection::set_cycle(double cycle) {
  if (cycle == cycle_) return;
  cycle_ = cycle;
  for (std::size_t id = 0; id < firing_time_.size(); ++id) {
    firing_time_[id] = std::llround(firing_[static_cast<Eigen::Index>(id)] * cycle * 1e9);
  }
}

const VelodyneProjection::Motion& VelodyneProjection::motion(double step) {
  // Means over 11 steps: neighbouring values fall into neighbouring places.
  Motion& motion = motions_[static_cast<std::uint64_t>(std::llround(step * 11)) % motions_.size()];
  if (motion.step != step || motion.sine[0].size() == 0) {
    motion.step = step;
    for (int half = 0; half < per_block_; ++half) {
      const Eigen::ArrayXd turned = step * centidegree / per_block_ * (firing_ + half);
      motion.sine[half] = sin_rotation_ * turned.cos() + cos_rotation_ * turned.sin();
      motion.cosine[half] = cos_rotation_ * turned.cos() - sin_rotation_ * turned.sin();
    }
  }
  return motion;
}

/// The manual's near-point correction of x and y, where the calibration has one (HDL-64E).
void VelodyneProjection::correct_near(int first, const Lanes& sine, const Lanes& cosine,
                                      BlockReturns& out) const {
  for (Eigen::Index i = 0; i < out.range.size(); ++i) {
    const Eigen::Index id = first + i;
    if (near_x_[id] == 0 || near_y_[id] == 0 || out.range[i] >= far_point) continue;
    const double dx =
        (distance_[id] - near_x_[id]) * (std::abs(out.x[i]) - near_point_x) / (far_point - near_point_x);
    const double dy =
        (distance_[id] - near_y_[id]) * (std::abs(out.y[i]) - near_point_y) / (far_point - near_point_y);
    const double measured = out.range[i] - distance_[id];
    out.x[i] =
        (measured + near_x_[id] + dx) * cos_vertical_[id] * sine[i] - horizontal_offset_[id] * cosine[i];
    out.y[i] =
        (measured + near_y_[id] + dy) * cos_vertical_[id] * cosine[i] + horizontal_offset_[id] * sine[i];
  }
}

void VelodyneProjection::project_block(const std::uint8_t* block, int bank, const VelodyneFiring& firing,
                                       BlockReturns& out) {
  using P = VelodynePacket;
  const int lasers = rings();
  const int n = std::min(lasers, P::channels);
  const int first = bank * P::channels;
  const int offset = lasers < P::channels ? firing.half * lasers : 0;
  out.counts.resize(n);
  out.intensity.resize(n);
  for (int i = 0; i < n; ++i) {
    out.counts[i] = P::distance(block, offset + i);
    out.intensity[i] = P::intensity(block, offset + i);
  }
  const auto& [head_sine, head_cosine] = head_table()[static_cast<std::size_t>(firing.azimuth)];
  const Motion& m = motion(firing.step[static_cast<std::size_t>(bank)]);
  const auto turn_sine = m.sine[firing.half].segment(first, n);
  const auto turn_cosine = m.cosine[firing.half].segment(first, n);
  const Lanes sine = head_sine * turn_cosine + head_cosine * turn_sine;
  const Lanes cosine = head_cosine * turn_cosine - head_sine * turn_sine;
  const auto h = horizontal_offset_.segment(first, n);
  out.range = out.counts * lsb_ + distance_.segment(first, n);
  const Lanes flat = out.range * cos_vertical_.segment(first, n);
  if (sideways_) {
    out.x = flat * sine - h * cosine;
    out.y = flat * cosine + h * sine;
  } else {
    out.x = flat * sine;
    out.y = flat * cosine;
  }
  out.z = out.range * sin_vertical_.segment(first, n) + vertical_offset_.segment(first, n);
  if (two_point_) correct_near(first, sine, cosine, out);
  if (corrected_intensity_) {
    const auto far = 256 * (1 - out.counts / 65535.0).square();
    const Lanes corrected =
        out.intensity + focal_slope_.segment(first, n) * (focal_.segment(first, n) - far).abs();
    out.intensity = corrected.max(min_intensity_.segment(first, n)).min(max_intensity_.segment(first, n));
  }
}

void VelodyneProjection::project(const VelodyneFiring& firing, std::int64_t time, std::uint32_t column,
                                 bool second_returns, VelodyneReturns& out) {
  using P = VelodynePacket;
  const std::int64_t start = time + std::llround(firing.cycle * cycle_ * 1e9);
  const int banks = (rings() + P::channels - 1) / P::channels;
  for (int bank = 0; bank < banks; ++bank) {
    const std::uint8_t* first = firing.blocks[0][static_cast<std::size_t>(bank)];
    const std::uint8_t* second = firing.blocks[1][static_cast<std::size_t>(bank)];
    if (!first) std::swap(first, second);
    if (!first) continue;
    project_block(first, bank, firing, returns_[0]);
    if (second) project_block(second, bank, firing, returns_[1]);
    std::size_t n = out.size;
    for (Eigen::Index i = 0; i < returns_[0].counts.size(); ++i) {
      const auto id = static_cast<std::size_t>(bank * P::channels + i);
      // Written in any case and kept if it is a return: cheaper than a branch taken at random.
      const auto keep = [&](const BlockReturns& r, bool wanted) {
        out.points[n] = Eigen::Vector3f(static_cast<float>(r.x[i]), static_cast<float>(r.y[i]),
                                        static_cast<float>(r.z[i]));
        if (exact_) out.exact[n] = {{r.x[i], r.y[i], r.z[i]}, r.range[i]};
        out.range[n] = static_cast<float>(r.range[i]);
        out.intensity[n] = static_cast<float>(r.intensity[i]);
        out.ring[n] = ring_[id];
        out.column[n] = column;
        out.time[n] = start + firing_time_[id];
        n += wanted;
      };
      const double counts = returns_[0].counts[i];
      keep(returns_[0], counts != 0);
      if (!second) continue;
      // Equal blocks mean that there was one return only.
      const double other = returns_[1].counts[i];
      keep(returns_[1], other != 0 && other != counts && (second_returns || counts == 0));
    }
    out.size = n;
  }
}

}  // namespace ca2
