/// `ca2 bench decode`: packets to points, against the least that could be done with them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

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
  std::size_t warm_up = 0;  ///< packets of the first revolutions, which find the memory and do not count

  void add(std::vector<EncodedPacket> revolution, bool counts) {
    if (!counts) warm_up += revolution.size();
    std::move(revolution.begin(), revolution.end(), std::back_inserter(packets));
  }
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

Stream ouster_stream(const std::string& profile, bool all_fields) {
  const OusterModel& model = *(*find_lidar_model("OS0-128"))->ouster();
  const OusterMetadata metadata = nominal_ouster_metadata(model, 1024, 10, profile);
  OusterOptions options;
  options.extra_fields = all_fields;
  Stream out{"OS0-128 " + profile + (all_fields ? ", all fields" : ""), {}, [metadata, options] {
               return std::make_unique<OusterDecoder>(metadata, options);
             }};
  std::mt19937_64 random(1);
  for (int i = -2; i < revolutions; ++i) {
    EncoderScan scan = random_scan(128, 1024, profile.ends_with("DUAL"), random);
    scan.frame_id = static_cast<std::uint32_t>(2 + i);
    out.add(encode_ouster(metadata, scan), i >= 0);
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
  for (int i = -2; i < revolutions; ++i) {
    EncoderScan scan = random_scan(model.lasers, columns, false, random);
    scan.start = (2 + i) * 100'000'000ll;
    out.add(encoder.push(scan), i >= 0);
  }
  return out;
}

/// As a daemon does day and night.
double decode_once(const Stream& stream, std::size_t& points) {
  const auto decoder = stream.decoder();
  LidarCounters counters;
  points = 0;
  const LidarSink sink = [&](LidarScan&& scan) { points += scan.scan.size(); };
  double start = 0;
  for (std::size_t i = 0; i < stream.packets.size(); ++i) {
    if (i == stream.warm_up) {
      points = 0;
      start = cpu_ns();
    }
    Datagram datagram;
    datagram.time = stream.packets[i].time;
    datagram.payload = stream.packets[i].bytes;
    decoder->push(datagram, counters, sink);
  }
  decoder->flush(counters, sink);
  return cpu_ns() - start;
}

/// A range loaded, a precomputed direction multiplied, a point stored.
class Floor {
 public:
  double once(std::size_t points) {
    const double start = cpu_ns();
    for (std::size_t done = 0; done < points; done += table) {
      const std::size_t n = std::min(table, points - done);
      for (std::size_t i = 0; i < n; ++i) out_[i] = static_cast<float>(ranges_[i]) * directions_[i];
      keep(out_.data());
    }
    return cpu_ns() - start;
  }

 private:
  static constexpr std::size_t table = 131072;
  std::vector<std::uint32_t> ranges_ = std::vector<std::uint32_t>(table, 5000);
  std::vector<Eigen::Vector3f> directions_ =
      std::vector<Eigen::Vector3f>(table, Eigen::Vector3f(1e-3f, 2e-3f, 3e-3f));
  std::vector<Eigen::Vector3f> out_ = std::vector<Eigen::Vector3f>(table, Eigen::Vector3f(0, 0, 0));
};

double copy_once(const Stream& stream) {
  std::vector<std::uint8_t> buffer(65536);
  const double start = cpu_ns();
  for (std::size_t i = stream.warm_up; i < stream.packets.size(); ++i) {
    const EncodedPacket& packet = stream.packets[i];
    std::memcpy(buffer.data(), packet.bytes.data(), packet.bytes.size());
    keep(buffer.data());
  }
  return cpu_ns() - start;
}

}  // namespace

Result<int> bench_decode(const BenchOptions& options) {
  nlohmann::ordered_json rows = nlohmann::json::array();
  if (!options.json) {
    std::printf("%-47s %9s %9s %9s %8s %8s\n", "ns per point, medians", "decode", "floor", "memcpy",
                "x floor", "% core");
  }
  std::vector<Stream> streams;
  for (const char* profile :
       {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8"}) {
    for (const bool all_fields : {false, true}) streams.push_back(ouster_stream(profile, all_fields));
  }
  for (const char* name : {"VLP-16", "HDL-32E", "VLP-32C", "HDL-64E-nominal", "VLS-128"}) {
    streams.push_back(velodyne_stream(name));
  }
  Floor least_loop;
  for (const Stream& stream : streams) {
    std::vector<double> decode, least, copy, ratios;
    std::size_t points = 0;
    const auto per_point = [&](double ns) { return ns / static_cast<double>(points); };
    for (int i = 0; i < options.repeats; ++i) {
      decode.push_back(per_point(decode_once(stream, points)));
      least.push_back(per_point(least_loop.once(points)));
      ratios.push_back(decode.back() / least.back());
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
                      {"ratio_to_floor", median(ratios)},
                      {"percent_of_core", percent}});
    } else {
      std::printf("%-47s %9.2f %9.2f %9.2f %8.1f %8.2f\n", stream.name.c_str(), ns, median(least),
                  median(copy), median(ratios), percent);
    }
  }
  if (options.json) std::puts(rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
