/// @file Scans made up for every model and profile, and the packets a sensor would send of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/decoder.h"
#include "drivers/lidar/ouster/profile.h"
#include "drivers/lidar/velodyne/decoder.h"

namespace ca2::test {

/// The same on every standard library.
inline double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// A grid with returns at random ranges of the wire's resolution, a fifth of them missing.
inline EncoderScan random_scan(int rings, int columns, double quantum, bool dual, std::mt19937_64& random) {
  EncoderScan scan;
  scan.rings = rings;
  scan.columns = columns;
  const auto size = static_cast<std::size_t>(rings) * static_cast<std::size_t>(columns);
  for (int i = 0; i < (dual ? 2 : 1); ++i) {
    scan.range[i].resize(size);
    scan.reflectivity[i].resize(size);
    for (std::size_t k = 0; k < size; ++k) {
      if (uniform(random) < 0.2) continue;
      if (i == 1 && uniform(random) < 0.5) continue;  // one return only
      if (i == 1 && scan.range[0][k] == 0) continue;
      scan.range[i][k] = static_cast<float>(quantum * std::floor((3 + 60 * uniform(random)) / quantum));
      scan.reflectivity[i][k] = static_cast<float>(std::floor(256 * uniform(random)));
    }
  }
  return scan;
}

/// A sensor to be: a model, and a profile (Ouster) or return mode (Velodyne).
struct SensorSetup {
  std::string name;
  const LidarModel* model = nullptr;
  std::string profile;
  int window_first = 0, window_last = -1;  ///< Ouster; -1: all
  std::uint8_t return_mode = 0x37;

  bool dual() const { return model->ouster() ? find_ouster_profile(profile)->dual() : return_mode == 0x39; }
  OusterMetadata metadata() const {
    OusterMetadata out = nominal_ouster_metadata(*model->ouster(), 512, 10, profile);
    out.serial = 122334455667;
    out.init_id = 0x123456;
    if (window_last >= 0) {
      out.window_first = window_first;
      out.window_last = window_last;
    }
    return out;
  }
  std::unique_ptr<PacketDecoder> decoder() const {
    if (model->ouster()) return std::make_unique<OusterDecoder>(metadata());
    return std::make_unique<VelodyneDecoder>(*model->velodyne(), model->velodyne()->factory,
                                             VelodyneOptions{});
  }
  /// The grid its encoder takes.
  BeamTable table() const { return *make_beam_table({model->name, {}, {}, 10, 512}); }
  double quantum() const {
    return model->ouster() ? find_ouster_profile(profile)->range_step() * 1e-3
                           : model->velodyne()->distance_lsb;
  }
  std::vector<EncodedPacket> encode(std::vector<EncoderScan> scans, std::int64_t start,
                                    std::uint32_t frame) const {
    std::vector<EncodedPacket> out;
    const auto append = [&](std::vector<EncodedPacket> packets) {
      for (EncodedPacket& packet : packets) out.push_back(std::move(packet));
    };
    std::unique_ptr<VelodyneEncoder> velodyne;
    if (const VelodyneModel* v = model->velodyne()) {
      velodyne = std::make_unique<VelodyneEncoder>(*v, v->factory, VelodyneEncoding{return_mode, 0, 10});
    }
    for (std::size_t i = 0; i < scans.size(); ++i) {
      scans[i].start = start + static_cast<std::int64_t>(i) * 100'000'000;
      scans[i].frame_id = frame + static_cast<std::uint32_t>(i);
      append(velodyne ? velodyne->push(scans[i]) : encode_ouster(metadata(), scans[i]));
    }
    if (velodyne) append(velodyne->flush());
    return out;
  }
};

inline std::vector<SensorSetup> setups() {
  std::vector<SensorSetup> out;
  const LidarModel* os = *find_lidar_model("OS1-32");
  for (const OusterProfile& profile : ouster_profiles()) {
    SensorSetup setup{std::string(profile.name), os, std::string(profile.name), 0, -1, 0};
    out.push_back(setup);
  }
  out.push_back({"window", os, "RNG19_RFL8_SIG16_NIR16", 37, 290, 0});
  out.push_back({"window_wraps", os, "RNG15_RFL8_NIR8", 370, 85, 0});
  for (const LidarModel& model : lidar_models()) {
    if (!model.velodyne() || model.velodyne()->factory.lasers.empty()) continue;
    for (const std::uint8_t mode : {std::uint8_t{0x37}, std::uint8_t{0x39}}) {
      SensorSetup setup{model.name + (mode == 0x39 ? "_dual" : ""), &model, "", 0, -1, mode};
      std::replace(setup.name.begin(), setup.name.end(), '-', '_');
      out.push_back(setup);
    }
  }
  return out;
}

inline std::vector<LidarScan> decode_packets(PacketDecoder& decoder,
                                             const std::vector<EncodedPacket>& packets,
                                             LidarCounters& counters) {
  std::vector<LidarScan> scans;
  const LidarSink sink = [&](LidarScan&& scan) { scans.push_back(std::move(scan)); };
  for (const EncodedPacket& packet : packets) {
    Datagram datagram;
    datagram.time = packet.time;
    datagram.payload = packet.bytes;
    decoder.push(datagram, counters, sink);
  }
  decoder.flush(counters, sink);
  return scans;
}

}  // namespace ca2::test
