#include "drivers/lidar/velodyne/projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "drivers/lidar/lanes.h"

namespace ca2 {
namespace {

using P = VelodynePacket;
using Bank = VelodyneProjection::Bank;
using Block = VelodyneProjection::Block;

constexpr double centidegree = std::numbers::pi / 18000;

/// Sine and cosine of every azimuth the wire can carry.
const std::vector<std::pair<float, float>>& head_table() {
  static const std::vector<std::pair<float, float>> table = [] {
    std::vector<std::pair<float, float>> out;
    out.reserve(P::azimuth_turn);
    for (int i = 0; i < P::azimuth_turn; ++i) {
      out.emplace_back(static_cast<float>(std::sin(i * centidegree)),
                       static_cast<float>(std::cos(i * centidegree)));
    }
    return out;
  }();
  return table;
}

/// Distances at which the near-point corrections were measured (HDL-64E manual), m.
constexpr double far_point = 25.04, near_point_x = 2.40, near_point_y = 1.93;

/// The manual's near-point correction is for this return.
bool is_near(const VelodyneLaser& laser, double range) {
  return laser.distance_x != 0 && laser.distance_y != 0 && range < far_point;
}

void read_block(const std::uint8_t* block, int offset, int lasers, Block& out) {
  constexpr int bytes = 3;  // of a channel: distance and intensity
  const std::uint8_t* at = block + 4 + bytes * offset;
#pragma GCC unroll 8
  for (int i = 0; i < lasers; ++i, at += bytes) {
    out.counts[static_cast<std::size_t>(i)] = load<std::uint16_t>(at);
    out.intensity[static_cast<std::size_t>(i)] = at[2];
  }
}

/// Equal blocks mean that there was one return only: it stays in the first, or in the last.
void leave_one_of_equal(Block (&returns)[2], int lasers, bool second_returns, bool in_last) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(lasers); ++i) {
    std::uint32_t &first = returns[0].counts[i], &last = returns[1].counts[i];
    const bool equal = first == last;
    const bool both = second_returns || first == 0;
    last = (equal ? in_last : both) ? last : 0;
    first = equal && in_last ? 0 : first;
  }
}

/// Where the head looks and how the lasers are turned from there.
struct Head {
  float sine, cosine;
  const VelodyneProjection::Turned& turned;
};

/// In single precision: within 4e-7 of the range, 40 um at 100 m, where the wire's step is 2 mm. Lasers
/// without a return are computed too.
CA2_LANES void project_block(const Block& block, const Bank& bank, const Head& head, float lsb, bool sideways,
                             int lasers, FiredBeams& out) {
  for (int i = 0; i < lasers; i += lanes::count) {
    const auto at = static_cast<std::size_t>(i);
    lanes::Floats counts, turn_sine, turn_cosine, distance, cos_vertical, sin_vertical, v;
    lanes::load(counts, &block.counts[at]);
    lanes::load(turn_sine, &head.turned.sine[at]);
    lanes::load(turn_cosine, &head.turned.cosine[at]);
    lanes::load(distance, &bank.distance[at]);
    lanes::load(cos_vertical, &bank.cos_vertical[at]);
    lanes::load(sin_vertical, &bank.sin_vertical[at]);
    lanes::load(v, &bank.vertical_offset[at]);
    const lanes::Floats sine = head.sine * turn_cosine + head.cosine * turn_sine;
    const lanes::Floats cosine = head.cosine * turn_cosine - head.sine * turn_sine;
    const lanes::Floats range = counts * lsb + distance;
    const lanes::Floats flat = range * cos_vertical;
    lanes::Floats x = flat * sine, y = flat * cosine;
    if (sideways) {
      lanes::Floats h;
      lanes::load(h, &bank.horizontal_offset[at]);
      x = x - h * cosine;
      y = y + h * sine;
    }
    lanes::store(out.x + i, x);
    lanes::store(out.y + i, y);
    lanes::store(out.z + i, range * sin_vertical + v);
    lanes::store(out.range + i, range);
  }
}

/// The manual's correction of intensities for the distance of the lasers' focus, in whole numbers as
/// VeloView.
void correct_intensities(Block& block, const Bank& bank, int lasers) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(lasers); ++i) {
    const float near = 1 - static_cast<float>(block.counts[i]) / 65535.0f, far = 256 * (near * near);
    const float corrected =
        static_cast<float>(block.intensity[i]) + bank.focal_slope[i] * std::abs(bank.focal[i] - far);
    block.intensity[i] =
        static_cast<std::uint8_t>(std::clamp(corrected, bank.min_intensity[i], bank.max_intensity[i]));
  }
}

}  // namespace

VelodyneProjection::VelodyneProjection(const VelodyneModel& model, const VelodyneCalibration& calibration,
                                       bool two_point)
    : calibration_(calibration),
      lsb_(model.distance_lsb),
      per_block_(model.firings_per_block()),
      lasers_(static_cast<int>(calibration.lasers.size())) {
  const std::size_t lasers = calibration.lasers.size();
  banks_.resize((lasers + P::channels - 1) / P::channels);
  for (std::size_t id = 0; id < lasers; ++id) {
    const VelodyneLaser& in = calibration.lasers[id];
    Bank& bank = banks_[id / P::channels];
    const std::size_t at = id % P::channels;
    bank.cos_vertical[at] = static_cast<float>(std::cos(in.vertical));
    bank.sin_vertical[at] = static_cast<float>(std::sin(in.vertical));
    bank.distance[at] = static_cast<float>(in.distance);
    bank.vertical_offset[at] = static_cast<float>(in.vertical_offset);
    bank.horizontal_offset[at] = static_cast<float>(in.horizontal_offset);
    bank.focal[at] = static_cast<float>(256 * std::pow(1 - in.focal_distance / 131.0, 2));
    bank.focal_slope[at] = static_cast<float>(in.focal_slope);
    const int least = std::clamp(in.min_intensity, 0, 255);
    bank.min_intensity[at] = static_cast<float>(least);
    bank.max_intensity[at] = static_cast<float>(std::clamp(in.max_intensity, least, 255));
    firing_.push_back(model.firing[id] / model.cycle);
    sideways_ = sideways_ || in.horizontal_offset != 0;
    two_point_ = two_point_ || (two_point && is_near(in, 0));
    corrected_intensity_ =
        corrected_intensity_ || in.focal_slope != 0 || in.min_intensity != 0 || in.max_intensity != 255;
  }
  for (const int ring : velodyne_rings(calibration)) ring_.push_back(static_cast<std::uint16_t>(ring));
  // Both are read in whole lanes, which all banks but the smallest model's fill.
  ring_.resize(banks_.size() * P::channels);
  delay_.resize(banks_.size() * P::channels);
  set_cycle(model.cycle);
}

void VelodyneProjection::set_cycle(double cycle) {
  // Far less than a firing's time is known to: what is measured changes with every packet.
  if (std::abs(cycle - cycle_) < 0.2e-9) return;
  cycle_ = cycle;
  for (std::size_t id = 0; id < firing_.size(); ++id) {
    delay_[id] = static_cast<std::int32_t>(std::lround(firing_[id] * cycle * 1e9));
  }
}

/// 0.01 degree that a laser looks beside its block's azimuth, but for its own rotation.
double VelodyneProjection::turned(std::size_t laser, double step, bool rounded, int half) const {
  const double turned = step / per_block_ * (firing_[laser] + half);
  return rounded ? std::floor(turned + 0.5) : turned;
}

const VelodyneProjection::Motion& VelodyneProjection::motion(double step, bool rounded) {
  const auto is_it = [&](const Motion& motion) {
    return motion.step == step && motion.rounded == rounded && !motion.turned[0].empty();
  };
  if (is_it(motions_[last_motion_])) return motions_[last_motion_];
  // Means over 11 steps: neighbouring values fall into neighbouring places.
  last_motion_ = static_cast<std::uint64_t>(std::llround(step * 11)) % motions_.size();
  Motion& motion = motions_[last_motion_];
  if (is_it(motion)) return motion;
  motion.step = step;
  motion.rounded = rounded;
  for (int half = 0; half < per_block_; ++half) {
    motion.turned[half].resize(banks_.size());
    for (std::size_t id = 0; id < firing_.size(); ++id) {
      const double azimuth = turned(id, step, rounded, half) * centidegree - calibration_.lasers[id].rotation;
      Turned& out = motion.turned[half][id / P::channels];
      out.sine[id % P::channels] = static_cast<float>(std::sin(azimuth));
      out.cosine[id % P::channels] = static_cast<float>(std::cos(azimuth));
    }
  }
  return motion;
}

/// In double precision, with the manual's near-point correction of x and y where it is wanted and the
/// calibration has one (HDL-64E).
ExactReturn VelodyneProjection::exact_return(int laser, const VelodyneFiring& firing,
                                             std::uint32_t counts) const {
  const auto id = static_cast<std::size_t>(laser);
  const VelodyneLaser& in = calibration_.lasers[id];
  const double beside = turned(id, firing.step[id / P::channels], firing.rounded, firing.half);
  const double a = (firing.azimuth + beside) * centidegree - in.rotation, sine = std::sin(a),
               cosine = std::cos(a);
  const double measured = counts * lsb_, range = measured + in.distance, h = in.horizontal_offset;
  const double flat = range * std::cos(in.vertical);
  ExactReturn out{{flat * sine - h * cosine, flat * cosine + h * sine,
                   range * std::sin(in.vertical) + in.vertical_offset},
                  range};
  if (two_point_ && is_near(in, range)) {
    const auto corrected = [&](double at_near, double near, double place) {
      const double share = (std::abs(place) - near) / (far_point - near);
      return (measured + at_near + (in.distance - at_near) * share) * std::cos(in.vertical);
    };
    out.point.x() = corrected(in.distance_x, near_point_x, out.point.x()) * sine - h * cosine;
    out.point.y() = corrected(in.distance_y, near_point_y, out.point.y()) * cosine + h * sine;
  }
  return out;
}

void VelodyneProjection::add_block(Block& block, int bank, const VelodyneFiring& firing, std::int64_t start,
                                   std::uint32_t column, ReturnWriter& out, std::vector<ExactReturn>* exact) {
  const auto at = static_cast<std::size_t>(bank);
  const int lasers = std::min(lasers_, P::channels), first = bank * P::channels;
  const auto& [sine, cosine] = head_table()[static_cast<std::size_t>(firing.azimuth)];
  const Head head{sine, cosine, motion(firing.step[at], firing.rounded).turned[firing.half][at]};
  project_block(block, banks_[at], head, static_cast<float>(lsb_), sideways_, lasers, beams_);
  if (corrected_intensity_) correct_intensities(block, banks_[at], lasers);
  if (exact || two_point_) {
    for (int i = 0; i < lasers; ++i) {
      const std::uint32_t counts = block.counts[static_cast<std::size_t>(i)];
      if (counts == 0) continue;
      const ExactReturn place = exact_return(first + i, firing, counts);
      if (exact) exact->push_back(place);
      if (two_point_ && is_near(calibration_.lasers[static_cast<std::size_t>(first + i)], place.range)) {
        beams_.x[i] = static_cast<float>(place.point.x());
        beams_.y[i] = static_cast<float>(place.point.y());
      }
    }
  }
  out.add(beams_, {block.counts.data(), block.intensity.data(), ring_.data() + first, delay_.data() + first,
                   column, start, lasers});
}

void VelodyneProjection::project(const VelodyneFiring& firing, std::int64_t time, std::uint32_t column,
                                 bool second_returns, ReturnWriter& out, std::vector<ExactReturn>* exact) {
  const std::int64_t start = time + std::llround(firing.cycle * cycle_ * 1e9);
  const int lasers = std::min(lasers_, P::channels);
  const int offset = firing.half * lasers;
  Block returns[2];
  std::optional<VelodyneFiring> ahead;
  if (firing.strongest_ahead) {
    ahead = firing;
    ahead->azimuth = (firing.azimuth + *firing.strongest_ahead + P::azimuth_turn) % P::azimuth_turn;
    ahead->step.fill(0);
  }
  for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
    const std::uint8_t* first = firing.blocks[0][bank];
    const std::uint8_t* second = firing.blocks[1][bank];
    if (!first) std::swap(first, second);
    if (!first) continue;
    read_block(first, offset, lasers, returns[0]);
    if (second) {
      read_block(second, offset, lasers, returns[1]);
      leave_one_of_equal(returns, lasers, second_returns, ahead.has_value());
    }
    add_block(returns[0], static_cast<int>(bank), second && ahead ? *ahead : firing, start, column, out,
              exact);
    if (second) add_block(returns[1], static_cast<int>(bank), firing, start, column, out, exact);
  }
}

}  // namespace ca2
