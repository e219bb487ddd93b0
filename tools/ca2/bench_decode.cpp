/// `ca2 bench decode`: packets to points, against the least that could be done with them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>

#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/decoder.h"
#include "drivers/lidar/velodyne/decoder.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

constexpr int revolutions = 4;

/// A sensor's packets of some revolutions, and what decodes them.
struct Stream {
  std::string name;
  std::vector<EncodedPacket> packets;
  std::function<std::unique_ptr<PacketDecoder>()> decoder;
};

EncoderScan random_scan(int rings, int columns, bool dual, std::mt19937_64& random) {
  EncoderScan scan;
  scan.rings = rings;
  scan.columns = columns;
  for (int i = 0; i < (dual ? 2 : 1); ++i) {
    scan.range[i].resize(static_cast<std::size_t>(rings) * static_cast<std::size_t>(columns));
    // One in eight without a return, as indoors.
    for (float& range : scan.range[i]) {
      const std::uint64_t draw = random();
      range = draw % 8 == 0 ? 0.0f : 2 + static_cast<float>(draw >> 40) * 3e-6f;
    }
  }
  return scan;
}

Stream ouster_stream(const char* profile) {
  const OusterModel& model = *(*find_lidar_model("OS0-128"))->ouster();
  const OusterMetadata metadata = nominal_ouster_metadata(model, 1024, 10, profile);
  Stream out{std::string("OS0-128 ") + profile, {}, [metadata] {
               return std::make_unique<OusterDecoder>(metadata);
             }};
  std::mt19937_64 random(1);
  for (int i = 0; i < revolutions; ++i) {
    EncoderScan scan = random_scan(128, 1024, std::string_view(profile).ends_with("DUAL"), random);
    scan.frame_id = static_cast<std::uint32_t>(i);
    for (EncodedPacket& packet : encode_ouster(metadata, scan)) out.packets.push_back(std::move(packet));
  }
  return out;
}

Stream velodyne_stream(const char* name) {
  const VelodyneModel& model = *(*find_lidar_model(name))->velodyne();
  Stream out{name, {}, [&model] {
               return std::make_unique<VelodyneDecoder>(model, model.factory, VelodyneOptions{});
             }};
  const int columns = static_cast<int>(0.1 / model.cycle);
  std::mt19937_64 random(2);
  VelodyneEncoder encoder(model, model.factory, {});
  for (int i = 0; i < revolutions; ++i) {
    EncoderScan scan = random_scan(model.lasers, columns, false, random);
    scan.start = i * 100'000'000ll;
    for (EncodedPacket& packet : encoder.push(scan)) out.packets.push_back(std::move(packet));
  }
  return out;
}

double decode_once(const Stream& stream, std::size_t& points) {
  const auto decoder = stream.decoder();
  LidarCounters counters;
  points = 0;
  const LidarSink sink = [&](LidarScan&& scan) { points += scan.scan.size(); };
  const double start = cpu_ns();
  for (const EncodedPacket& packet : stream.packets) {
    Datagram datagram;
    datagram.time = packet.time;
    datagram.payload = packet.bytes;
    decoder->push(datagram, counters, sink);
  }
  decoder->flush(counters, sink);
  return cpu_ns() - start;
}

/// A range loaded, a precomputed direction multiplied, a point stored.
double floor_once(std::size_t points) {
  constexpr std::size_t table = 131072;
  std::vector<std::uint32_t> ranges(table, 5000);
  std::vector<Eigen::Vector3f> directions(table, Eigen::Vector3f(1e-3f, 2e-3f, 3e-3f));
  std::vector<Eigen::Vector3f> out(table);
  keep(ranges.data());
  keep(directions.data());
  const double start = cpu_ns();
  for (std::size_t done = 0; done < points; done += table) {
    const std::size_t n = std::min(table, points - done);
    for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<float>(ranges[i]) * directions[i];
    keep(out.data());
  }
  return cpu_ns() - start;
}

double copy_once(const Stream& stream) {
  std::vector<std::uint8_t> buffer(65536);
  const double start = cpu_ns();
  for (const EncodedPacket& packet : stream.packets) {
    std::memcpy(buffer.data(), packet.bytes.data(), packet.bytes.size());
    keep(buffer.data());
  }
  return cpu_ns() - start;
}

}  // namespace

Result<int> bench_decode(const BenchOptions& options) {
  nlohmann::ordered_json rows = nlohmann::json::array();
  if (!options.json) {
    std::printf("%-38s %9s %9s %9s %8s %8s\n", "ns per point, medians", "decode", "floor", "memcpy",
                "x floor", "% core");
  }
  std::vector<Stream> streams;
  for (const char* profile :
       {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8"}) {
    streams.push_back(ouster_stream(profile));
  }
  for (const char* name : {"VLP-16", "HDL-32E", "VLP-32C", "HDL-64E-nominal", "VLS-128"}) {
    streams.push_back(velodyne_stream(name));
  }
  for (const Stream& stream : streams) {
    std::vector<double> decode, least, copy;
    std::size_t points = 0;
    decode_once(stream, points);  // warms up
    const auto per_point = [&](double ns) { return ns / static_cast<double>(points); };
    for (int i = 0; i < options.repeats; ++i) {
      decode.push_back(per_point(decode_once(stream, points)));
      least.push_back(per_point(floor_once(points)));
      copy.push_back(per_point(copy_once(stream)));
    }
    const double ns = median(decode);
    // Of one core, at ten revolutions per second.
    const double percent = ns * static_cast<double>(points) / revolutions * 10 * 1e-9 * 100;
    if (options.json) {
      rows.push_back({{"stream", stream.name},
                      {"points", points},
                      {"decode_ns", ns},
                      {"floor_ns", median(least)},
                      {"memcpy_ns", median(copy)},
                      {"ratio_to_floor", ns / median(least)},
                      {"percent_of_core", percent}});
    } else {
      std::printf("%-38s %9.2f %9.2f %9.2f %8.1f %8.2f\n", stream.name.c_str(), ns, median(least),
                  median(copy), ns / median(least), percent);
    }
  }
  if (options.json) std::puts(rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
