#include "drivers/lidar/velodyne/projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "drivers/lidar/avx512.h"
#include "drivers/lidar/velodyne/block_returns.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

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

constexpr int channel_bytes = 3;  // distance and intensity

#if defined(__x86_64__)
/// Eight channels at a time; reads four bytes beyond the last, which a packet has after its last block.
__attribute__((target("avx2"))) void read_channels_avx2(const std::uint8_t* at, int channels, Block& out) {
  const __m256i of_counts =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 1, -1, -1, 3, 4, -1, -1, 6, 7, -1, -1, 9, 10, -1, -1));
  const __m256i of_intensity = _mm256_set1_epi32(2 | 5 << 8 | 8 << 16 | 11 << 24);
  const __m256i ends = _mm256_setr_epi32(0, 4, 0, 4, 0, 4, 0, 4);
  const auto four = [](const std::uint8_t* from) __attribute__((target("avx2"))) {
    return _mm_loadu_si128(static_cast<const __m128i*>(static_cast<const void*>(from)));
  };
  for (int i = 0; i < channels; i += 8, at += 8 * channel_bytes) {
    const __m256i eight = _mm256_set_m128i(four(at + 4 * channel_bytes), four(at));
    _mm256_storeu_si256(static_cast<__m256i*>(static_cast<void*>(out.counts.data() + i)),
                        _mm256_shuffle_epi8(eight, of_counts));
    const __m256i bytes = _mm256_permutevar8x32_epi32(_mm256_shuffle_epi8(eight, of_intensity), ends);
    _mm_storel_epi64(static_cast<__m128i*>(static_cast<void*>(out.intensity.data() + i)),
                     _mm256_castsi256_si128(bytes));
  }
}
#endif

void read_block(const std::uint8_t* block, int channels, Block& out) {
  const std::uint8_t* at = block + 4;
#if defined(__x86_64__)
  static const bool avx2 = __builtin_cpu_supports("avx2");
  if (avx2) return read_channels_avx2(at, channels, out);
#endif
#pragma GCC unroll 8
  for (int i = 0; i < channels; ++i, at += channel_bytes) {
    out.counts[static_cast<std::size_t>(i)] = load<std::uint16_t>(at);
    out.intensity[static_cast<std::size_t>(i)] = at[2];
  }
}

/// Equal blocks mean that there was one return only: it stays in the first, or in the last.
void leave_one_of_equal(Block& firsts, Block& lasts, int channels, bool second_returns, bool in_last) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels); ++i) {
    std::uint32_t &first = firsts.counts[i], &last = lasts.counts[i];
    const bool equal = first == last;
    const bool both = second_returns || first == 0;
    last = (equal ? in_last : both) ? last : 0;
    first = equal && in_last ? 0 : first;
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
      lasers_(static_cast<int>(calibration.lasers.size())),
      fired_(std::min(lasers_, P::channels / per_block_)),
      head_(head_table().data()) {
  const std::size_t lasers = calibration.lasers.size();
  banks_.resize((lasers + P::channels - 1) / P::channels);
  for (std::size_t id = 0; id < lasers; ++id) {
    const VelodyneLaser& in = calibration.lasers[id];
    Bank& bank = banks_[id / P::channels];
    const int least = std::clamp(in.min_intensity, 0, 255);
    for (int half = 0; half < per_block_; ++half) {
      const std::size_t at = id % P::channels + static_cast<std::size_t>(half * fired_);
      bank.cos_vertical[at] = static_cast<float>(std::cos(in.vertical));
      bank.sin_vertical[at] = static_cast<float>(std::sin(in.vertical));
      bank.distance[at] = static_cast<float>(in.distance);
      bank.vertical_offset[at] = static_cast<float>(in.vertical_offset);
      bank.horizontal_offset[at] = static_cast<float>(in.horizontal_offset);
      bank.focal[at] = static_cast<float>(256 * std::pow(1 - in.focal_distance / 131.0, 2));
      bank.focal_slope[at] = static_cast<float>(in.focal_slope);
      bank.min_intensity[at] = static_cast<float>(least);
      bank.max_intensity[at] = static_cast<float>(std::clamp(in.max_intensity, least, 255));
    }
    firing_.push_back(model.firing[id] / model.cycle);
    sideways_ = sideways_ || in.horizontal_offset != 0;
    two_point_ = two_point_ || (two_point && is_near(in, 0));
    corrected_intensity_ =
        corrected_intensity_ || in.focal_slope != 0 || in.min_intensity != 0 || in.max_intensity != 255;
  }
  for (const int ring : velodyne_rings(calibration)) ring_.push_back(static_cast<std::uint16_t>(ring));
  // Both are read in whole lanes.
  ring_.resize(banks_.size() * P::channels);
  delay_.resize(banks_.size() * P::channels);
  set_cycle(model.cycle);
#if defined(__x86_64__)
  at_once_ = has_avx512() && !two_point_ && !corrected_intensity_;
#endif
}

void VelodyneProjection::set_cycle(double cycle) {
  // Far less than a firing's time is known to: what is measured changes with every packet.
  if (std::abs(cycle - cycle_) < 0.2e-9) return;
  cycle_ = cycle;
  for (std::size_t id = 0; id < firing_.size(); ++id) {
    delay_[id] = static_cast<std::int32_t>(std::lround(firing_[id] * cycle * 1e9));
  }
  for (std::size_t i = 0; i < after_cycles_.size(); ++i) {
    after_cycles_[i] = std::llround(static_cast<double>(i) * cycle * 1e9);
  }
}

/// 0.01 degree that a laser looks beside its block's azimuth, but for its own rotation.
double VelodyneProjection::turned(std::size_t laser, double step, bool rounded, int half) const {
  const double turned = step / per_block_ * (firing_[laser] + half);
  return rounded ? std::floor(turned + 0.5) : turned;
}

const VelodyneProjection::Motion& VelodyneProjection::motion(double step, bool rounded) {
  const auto is_it = [&](const Motion& motion) {
    return motion.step == step && motion.rounded == rounded && !motion.turned.empty();
  };
  if (is_it(motions_[last_motion_])) return motions_[last_motion_];
  // Means over 11 steps: neighbouring values fall into neighbouring places.
  last_motion_ = static_cast<std::uint64_t>(std::llround(step * 11)) % motions_.size();
  Motion& motion = motions_[last_motion_];
  if (is_it(motion)) return motion;
  motion.step = step;
  motion.rounded = rounded;
  motion.turned.resize(banks_.size());
  for (int half = 0; half < per_block_; ++half) {
    for (std::size_t id = 0; id < firing_.size(); ++id) {
      const double azimuth = turned(id, step, rounded, half) * centidegree - calibration_.lasers[id].rotation;
      Turned& out = motion.turned[id / P::channels];
      const std::size_t channel = id % P::channels + static_cast<std::size_t>(half * fired_);
      out.sine[channel] = static_cast<float>(std::sin(azimuth));
      out.cosine[channel] = static_cast<float>(std::cos(azimuth));
    }
  }
  return motion;
}

/// In double precision, with the manual's near-point correction of x and y where it is wanted and the
/// calibration has one (HDL-64E).
ExactReturn VelodyneProjection::exact_return(std::size_t laser, const Returns& returns, bool rounded,
                                             int half, std::uint32_t counts) const {
  const VelodyneLaser& in = calibration_.lasers[laser];
  const double beside = turned(laser, returns.step, rounded, half);
  const double a = (returns.azimuth + beside) * centidegree - in.rotation, sine = std::sin(a),
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

detail::VelodyneBlockPlace VelodyneProjection::place_of(int azimuth, double step, std::size_t bank,
                                                        bool rounded) {
  const auto& [sine, cosine] = head_[static_cast<std::size_t>(azimuth)];
  return {sine,     cosine, motion(step, rounded).turned[bank], banks_[bank], static_cast<float>(lsb_),
          sideways_};
}

void VelodyneProjection::add_exact(Returns& returns, std::size_t bank, bool rounded, int half,
                                   std::vector<ExactReturn>* exact) const {
  for (int i = 0; i < fired_; ++i) {
    const int channel = half * fired_ + i;
    const std::uint32_t counts = returns.block.counts[static_cast<std::size_t>(channel)];
    if (counts == 0) continue;
    const auto laser = bank * P::channels + static_cast<std::size_t>(i);
    const ExactReturn place = exact_return(laser, returns, rounded, half, counts);
    if (exact) exact->push_back(place);
    if (two_point_ && is_near(calibration_.lasers[laser], place.range)) {
      returns.beams.x[channel] = static_cast<float>(place.point.x());
      returns.beams.y[channel] = static_cast<float>(place.point.y());
    }
  }
}

void VelodyneProjection::fetch(const VelodyneFirings& firings) const {
  for (int i = 0; i < firings.count; ++i) {
    const VelodyneFiring& firing = firings.firing[static_cast<std::size_t>(i)];
    __builtin_prefetch(&head_[static_cast<std::size_t>(firing.azimuth)]);
  }
}

void VelodyneProjection::project(const VelodyneFiring& firing, std::int64_t time, std::uint32_t column,
                                 bool second_returns, ReturnWriter& out, std::vector<ExactReturn>* exact) {
  const int channels = fired_ * per_block_;
  for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
    const std::uint8_t* first = firing.blocks[0][bank];
    const std::uint8_t* second = firing.blocks[1][bank];
    if (!first) std::swap(first, second);
    if (!first) continue;
    const std::size_t laser = bank * P::channels;
    const auto names_of = [&](const Block& block, int half) {
      const auto channel = static_cast<std::size_t>(half * fired_);
      return FiredNames{&block.counts[channel],
                        &block.intensity[channel],
                        &ring_[laser],
                        &delay_[laser],
                        column + static_cast<std::uint32_t>(half),
                        time + after_cycles_[static_cast<std::size_t>(firing.cycle + half)],
                        fired_,
                        half * fired_};
    };
#if defined(__x86_64__)
    if (at_once_ && !second && !exact) {
      const detail::VelodyneBlockPlace place =
          place_of(firing.azimuth, firing.step[bank], bank, firing.rounded);
      for (int half = 0; half < per_block_; ++half) {
        out.add_by(fired_, [&](const detail::ReturnTargets& to, std::size_t at) {
          return detail::write_velodyne_block_avx512(first, place, names_of(returns_[0].block, half), to, at);
        });
      }
      continue;
    }
#endif
    const std::span<Returns> all(returns_.data(), second ? 2 : 1);
    for (Returns& returns : all) {
      returns.azimuth = firing.azimuth;
      returns.step = firing.step[bank];
    }
    read_block(first, channels, all.front().block);
    if (second) {
      read_block(second, channels, all.back().block);
      leave_one_of_equal(all.front().block, all.back().block, channels, second_returns,
                         firing.strongest_ahead.has_value());
      if (firing.strongest_ahead) {
        all.front().azimuth = (firing.azimuth + *firing.strongest_ahead + P::azimuth_turn) % P::azimuth_turn;
        all.front().step = 0;
      }
    }
    for (Returns& returns : all) {
      detail::project_velodyne_block(returns.block,
                                     place_of(returns.azimuth, returns.step, bank, firing.rounded), channels,
                                     returns.beams);
      if (corrected_intensity_) correct_intensities(returns.block, banks_[bank], channels);
    }
    for (int half = 0; half < per_block_; ++half) {
      for (Returns& returns : all) {
        if (exact || two_point_) add_exact(returns, bank, firing.rounded, half, exact);
        out.add(returns.beams, names_of(returns.block, half));
      }
    }
  }
}

}  // namespace ca2
