#include "drivers/lidar/velodyne/decoder.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

using P = VelodynePacket;

/// s per block of an HDL-64E S1, from its packet rate; its time stamps come from the host.
constexpr double untimed_cycle = 32e-6;
/// Of an HDL-32E, and of a VLP-16 with firmware of 2014.
constexpr std::uint8_t shared_product_id = 0x21;
/// 0.01 degree per second at 10 Hz, until the packets tell.
constexpr double usual_rate = 360000;

}  // namespace

VelodyneDecoder::VelodyneDecoder(const VelodyneModel& model,
                                 const std::optional<VelodyneCalibration>& calibration,
                                 const VelodyneOptions& options)
    : model_(model),
      options_(options),
      cutter_(options.cut_azimuth),
      cycle_(model.cycle),
      step_(usual_rate * model.cycle) {
  if (calibration) use(*calibration);
}

void VelodyneDecoder::use(const VelodyneCalibration& calibration) {
  projection_.emplace(model_, calibration, options_.two_point_correction);
  writer_.begin(scan_.scan, 0);
}

void VelodyneDecoder::push(const Datagram& datagram, LidarCounters& counters, const LidarSink& sink) {
  const std::uint8_t* packet = datagram.payload.data();
  if (datagram.payload.size() == P::position_bytes) {
    ++counters.position_packets;
    return;
  }
  if (datagram.payload.size() != P::bytes) {
    ++counters.wrong_size;
    return;
  }
  if (velodyne_other_model(model_, packet)) {
    ++counters.other_sensor;
    return;
  }
  const std::optional<VelodyneLayout> layout = find_velodyne_layout(model_, packet);
  if (!layout) {
    ++counters.unknown_return_mode;
    return;
  }
  const bool shared_number = P::product_id(packet) == 0 || P::product_id(packet) == shared_product_id;
  if (shared_number && *layout != VelodyneLayout::apart && !model_.product_ids.empty() &&
      pace_.other_model(P::timestamp(packet), velodyne_cycles(model_, *layout) * cycle_)) {
    ++counters.other_sensor;
    return;
  }
  // The layout of a packet that waited is looked up again: the return mode may change on the fly.
  const auto next = [&](const OrderedPacket& ordered) {
    take(ordered, *find_velodyne_layout(model_, ordered.bytes), counters, sink);
  };
  if (*layout == VelodyneLayout::apart) {
    order_.push_untimed(packet, datagram.time, untimed_cycle * P::blocks, counters, next);
  } else {
    order_.push(packet, datagram.time, velodyne_cycles(model_, *layout) * cycle_, counters, next);
  }
}

void VelodyneDecoder::flush(LidarCounters& counters, const LidarSink& sink) {
  if (pace_.other_model()) return;  // what was begun is no scan of this sensor
  order_.flush(counters, [&](const OrderedPacket& ordered) {
    take(ordered, *find_velodyne_layout(model_, ordered.bytes), counters, sink);
  });
  give_out(counters, sink, false);
  cutter_.reset();
  last_.reset();
}

/// Cycles differ by firmware (VLS-128) and generation (HDL-64E): the mean over packets without a gap.
void VelodyneDecoder::measure_cycle(const OrderedPacket& packet, int cycles) {
  if (!model_.cycle_from_timestamps || packet.gap > 0 || packet.restart || !last_) return;
  const std::int64_t time = packet.device_time - last_->device_time;
  const double cycle = static_cast<double>(time) * 1e-9 / last_cycles_;
  if (cycle < 0.9 * model_.cycle || cycle > 1.3 * model_.cycle || cycles != last_cycles_) return;
  measured_time_ += time;
  measured_cycles_ += last_cycles_;
  cycle_ = static_cast<double>(measured_time_) * 1e-9 / static_cast<double>(measured_cycles_);
}

void VelodyneDecoder::take(const OrderedPacket& packet, VelodyneLayout layout, LidarCounters& counters,
                           const LidarSink& sink) {
  const int cycles = velodyne_cycles(model_, layout);
  if (!projection_) {
    if (packet.gap > 0 || packet.restart) streamed_.lost();
    ++counters.waiting_for_calibration;
    if (const auto calibration = streamed_.push(packet.bytes[1204], packet.bytes[1205])) {
      use(*calibration);
    }
    return;
  }
  if (packet.restart) {
    give_out(counters, sink, false);
    cutter_.reset();
    last_.reset();
  }
  const bool timed = layout != VelodyneLayout::apart;
  measure_cycle(packet, cycles);
  const double cycle = timed ? cycle_ : untimed_cycle;
  VelodyneFirings& firings = firings_;
  read_velodyne_firings(model_, layout, options_.azimuth, packet.bytes, firings);
  counters.bad_columns += static_cast<std::uint64_t>(firings.bad_blocks);
  if (firings.count == 0) return;
  projection_->fetch(firings);
  ++counters.lidar_packets;

  const std::int64_t missing = std::llround(packet.gap / cycle);
  const int azimuth = firings.firing[0].azimuth;
  const bool alone = firings.count == 1 && model_.firings_per_block() == 1;
  if (firings.count > 1) {
    const int turned =
        (firings.firing[static_cast<std::size_t>(firings.count - 1)].azimuth - azimuth + P::azimuth_turn) %
        P::azimuth_turn;
    const int over = firings.firing[static_cast<std::size_t>(firings.count - 1)].cycle;
    if (turned > 0 && turned < P::azimuth_turn / 8 && over > 0) step_ = static_cast<double>(turned) / over;
  } else if (alone && last_ && packet.gap == 0) {
    // One firing to a packet (VLS-128, dual): the step from packet to packet.
    const int turned = (azimuth - last_azimuth_ + P::azimuth_turn) % P::azimuth_turn;
    if (turned > 0 && turned < P::azimuth_turn / 8) step_ = static_cast<double>(turned) / last_cycles_;
  }
  if (alone && options_.azimuth == VelodyneAzimuth::times) firings.firing[0].step.fill(step_);
  if (last_) firing_number_ += last_cycles_ + missing;
  projection_->set_cycle(cycle);
  const std::int64_t start = packet.device_time + (timed ? std::llround(model_.epoch * 1e9) : 0);

  std::vector<ExactReturn>* const exact = options_.exact ? &scan_.exact : nullptr;
  for (int i = 0; i < firings.count; ++i) {
    const VelodyneFiring& firing = firings.firing[static_cast<std::size_t>(i)];
    const std::int64_t number = firing_number_ + firing.cycle;
    const bool after_gap = i == 0 && missing > 0;
    if (cutter_.begins(firing.azimuth, after_gap ? step_ * static_cast<double>(missing) : 0)) {
      give_out(counters, sink, !after_gap);
      begun_at_cut_ = !after_gap;
      // Where the first firings of a scan are missing, their number follows from how far the head has turned.
      const int past = after_gap ? static_cast<int>(cutter_.past_cut(firing.azimuth) / step_) : 0;
      scan_first_ = number - past;
    } else if (!last_ && i == 0) {
      scan_first_ = number;
      begun_at_cut_ = false;
    }
    const auto column = static_cast<std::uint32_t>(number - scan_first_);
    projection_->project(firing, start, column, options_.second_returns, writer_, exact);
    scan_.scan.columns = std::max(scan_.scan.columns, static_cast<int>(column) + model_.firings_per_block());
  }
  if (missing > 0) scan_.missing_packets += static_cast<int>((missing + cycles / 2) / cycles);
  scan_.clock.push_back({packet.device_time, packet.host_time});
  last_ = packet;
  last_->bytes = nullptr;
  last_cycles_ = cycles;
  last_azimuth_ = azimuth;
}

void VelodyneDecoder::give_out(LidarCounters& counters, const LidarSink& sink, bool whole) {
  if (scan_.scan.columns == 0) {
    reuse(scan_);
    return;
  }
  scan_.scan.rings = projection_->rings();
  scan_.frame_id = scan_count_++;
  scan_.complete = whole && begun_at_cut_ && scan_.missing_packets == 0;
  ++counters.frames;
  if (!scan_.complete) ++counters.incomplete_frames;
  writer_.finish();
  // The next revolution is about as large as this one.
  const std::size_t expected = writer_.size() + writer_.size() / 8;
  sink(std::move(scan_));
  reuse(scan_);
  writer_.begin(scan_.scan, expected);
}

}  // namespace ca2
