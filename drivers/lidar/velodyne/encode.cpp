#include <algorithm>
#include <cmath>

#include "drivers/lidar/encode.h"
#include "drivers/lidar/velodyne/packet.h"

namespace ca2 {
namespace {

using P = VelodynePacket;

}  // namespace

VelodyneEncoder::VelodyneEncoder(const VelodyneModel& model, const VelodyneCalibration& calibration,
                                 const VelodyneEncoding& encoding)
    : model_(model), calibration_(calibration), encoding_(encoding), rings_(velodyne_rings(calibration)) {
  if (encoding_.product_id == 0 && !model_.product_ids.empty()) encoding_.product_id = model_.product_ids[0];
}

int VelodyneEncoder::firings_per_packet() const {
  const int returns = encoding_.return_mode == P::mode_dual ? 2 : 1;
  return P::blocks / (returns * model_.blocks_per_firing()) * model_.firings_per_block();
}

VelodyneEncoder::Firing VelodyneEncoder::make_firing(const EncoderScan& scan, int column) const {
  Firing firing;
  firing.time = scan.start + std::llround(column * model_.cycle * 1e9);
  firing.azimuth = scan.azimuth + column * model_.cycle * encoding_.rate;
  const auto lasers = static_cast<std::size_t>(model_.lasers);
  for (std::size_t i = 0; i < 2; ++i) {
    firing.counts[i].resize(lasers);
    firing.intensity[i].resize(lasers);
    if (scan.range[i].empty()) continue;
    for (std::size_t id = 0; id < lasers; ++id) {
      const std::size_t at = static_cast<std::size_t>(rings_[id]) * scan.columns + column;
      const double range = scan.range[i][at];
      if (!(range > 0)) continue;
      const double counts = (range - calibration_.lasers[id].distance) / model_.distance_lsb;
      firing.counts[i][id] = static_cast<std::uint16_t>(std::clamp(std::round(counts), 0.0, 65535.0));
      const double reflectivity = scan.reflectivity[i].empty() ? 100 : scan.reflectivity[i][at];
      firing.intensity[i][id] = static_cast<std::uint8_t>(std::clamp(std::round(reflectivity), 0.0, 255.0));
    }
  }
  // One return only: both blocks of a pair say the same.
  for (std::size_t id = 0; id < lasers; ++id) {
    if (firing.counts[1][id] != 0) continue;
    firing.counts[1][id] = firing.counts[0][id];
    firing.intensity[1][id] = firing.intensity[0][id];
  }
  return firing;
}

void VelodyneEncoder::write_block(std::uint8_t* block, const Firing& firing, const Firing* second_half,
                                  int bank, int ret) const {
  store(block, P::bank_flags[bank]);
  const double turns = firing.azimuth - std::floor(firing.azimuth);
  store(block + 2, static_cast<std::uint16_t>(std::lround(turns * P::azimuth_turn) % P::azimuth_turn));
  const int channels = std::min(model_.lasers, P::channels);
  for (int half = 0; half < (second_half ? 2 : 1); ++half) {
    const Firing& source = half == 0 ? firing : *second_half;
    for (int channel = 0; channel < channels; ++channel) {
      const auto id = static_cast<std::size_t>(bank * P::channels + channel);
      std::uint8_t* at = block + 4 + 3 * (half * channels + channel);
      store(at, source.counts[static_cast<std::size_t>(ret)][id]);
      at[2] = source.intensity[static_cast<std::size_t>(ret)][id];
    }
  }
}

EncodedPacket VelodyneEncoder::make_packet(const std::vector<Firing>& firings) const {
  const bool dual = encoding_.return_mode == P::mode_dual;
  const int banks = model_.blocks_per_firing(), per_block = model_.firings_per_block();
  EncodedPacket packet;
  packet.bytes.resize(P::bytes);
  int block = 0;
  for (std::size_t i = 0; i < firings.size(); i += static_cast<std::size_t>(per_block)) {
    const Firing* second_half = per_block == 2 ? &firings[i + 1] : nullptr;
    const auto write = [&](int bank, int ret) {
      write_block(packet.bytes.data() + static_cast<std::size_t>(block++) * P::block_bytes, firings[i],
                  second_half, bank, ret);
    };
    if (dual && model_.dual == VelodyneDual::groups) {
      for (const int ret : {0, 1}) {
        for (int bank = 0; bank < banks; ++bank) write(bank, ret);
      }
    } else {
      for (int bank = 0; bank < banks; ++bank) {
        if (dual) write(bank, 1);  // last, then strongest
        write(bank, 0);
      }
    }
  }
  const std::int64_t start = firings.front().time - std::llround(model_.epoch * 1e9);
  constexpr std::int64_t hour = 3'600'000'000;
  const std::int64_t us = (start / 1000) % hour;
  store(packet.bytes.data() + 1200, static_cast<std::uint32_t>(us < 0 ? us + hour : us));
  packet.bytes[1204] = model_.product_ids.empty() ? 'T' : encoding_.return_mode;
  packet.bytes[1205] = model_.product_ids.empty() ? 45 : encoding_.product_id;  // HDL-64E: temperature, deg C
  packet.time = firings.back().time + std::llround(model_.cycle * 1e9);
  return packet;
}

std::vector<EncodedPacket> VelodyneEncoder::push(const EncoderScan& scan) {
  std::vector<EncodedPacket> packets;
  if (scan.rings != model_.lasers) return packets;
  const auto size = static_cast<std::size_t>(firings_per_packet());
  for (int column = 0; column < scan.columns; ++column) {
    waiting_.push_back(make_firing(scan, column));
    if (waiting_.size() < size) continue;
    packets.push_back(make_packet(waiting_));
    waiting_.clear();
  }
  return packets;
}

std::vector<EncodedPacket> VelodyneEncoder::flush() {
  std::vector<EncodedPacket> packets;
  if (waiting_.empty()) return packets;
  while (waiting_.size() < static_cast<std::size_t>(firings_per_packet())) {
    Firing empty = waiting_.back();
    empty.time += std::llround(model_.cycle * 1e9);
    empty.azimuth += model_.cycle * encoding_.rate;
    for (auto& counts : empty.counts) std::fill(counts.begin(), counts.end(), std::uint16_t{0});
    waiting_.push_back(std::move(empty));
  }
  packets.push_back(make_packet(waiting_));
  waiting_.clear();
  return packets;
}

}  // namespace ca2
