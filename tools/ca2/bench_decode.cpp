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
  std::size_t pixels = 0;   ///< of the others, with a return or without

  void add(std::vector<EncodedPacket> revolution, const EncoderScan& scan, bool counts) {
    if (counts) pixels += scan.range[0].size() + scan.range[1].size();
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

Stream ouster_stream(const std::string& name, const std::string& profile, bool all_fields) {
  const OusterModel& model = *(*find_lidar_model("OS0-128"))->ouster();
  const OusterMetadata metadata = nominal_ouster_metadata(model, 1024, 10, profile);
  OusterOptions options;
  options.extra_fields = all_fields;
  Stream out{name, {}, [metadata, options] { return std::make_unique<OusterDecoder>(metadata, options); }};
  std::mt19937_64 random(1);
  for (int i = -2; i < revolutions; ++i) {
    EncoderScan scan = random_scan(128, 1024, profile.ends_with("DUAL"), random);
    scan.frame_id = static_cast<std::uint32_t>(2 + i);
    out.add(encode_ouster(metadata, scan), scan, i >= 0);
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
    out.add(encoder.push(scan), scan, i >= 0);
  }
  return out;
}

/// As a daemon does day and night: packets are decoded soon after the kernel has copied them, out of its
/// cache.
double decode_once(const Stream& stream, std::size_t& points) {
  const auto decoder = stream.decoder();
  LidarCounters counters;
  points = 0;
  const LidarSink sink = [&](LidarScan&& scan) { points += scan.scan.size(); };
  std::vector<std::uint8_t> received(256 << 10);
  double taken = 0;
  for (std::size_t next = 0; next < stream.packets.size();) {
    if (next == stream.warm_up) points = 0, taken = 0;
    std::vector<Datagram> batch;
    std::size_t used = 0;
    for (; next < stream.packets.size(); ++next) {
      const EncodedPacket& packet = stream.packets[next];
      if (used + packet.bytes.size() > received.size() || (next == stream.warm_up && !batch.empty())) break;
      std::copy(packet.bytes.begin(), packet.bytes.end(), received.data() + used);
      batch.emplace_back().time = packet.time;
      batch.back().payload = {received.data() + used, packet.bytes.size()};
      used += packet.bytes.size();
    }
    const double start = cpu_ns();
    for (const Datagram& datagram : batch) decoder->push(datagram, counters, sink);
    taken += cpu_ns() - start;
  }
  const double start = cpu_ns();
  decoder->flush(counters, sink);
  return taken + cpu_ns() - start;
}

/// For every pixel or laser of the packets, with a return or without: a range loaded, a precomputed direction
/// multiplied, a point stored.
class Floor {
 public:
  double once(std::size_t pixels) {
    const double start = cpu_ns();
    for (std::size_t done = 0; done < pixels; done += table) {
      points(ranges_.data(), directions_.data(), std::min(table, pixels - done), out_.data());
      keep(out_.data());
    }
    return cpu_ns() - start;
  }

 private:
  /// Of plain numbers, at a place of its own: what a compiler makes of a vector class, and where a short loop
  /// lies in memory, change its speed by a third.
  __attribute__((noinline, aligned(64))) static void points(const std::int32_t* range,
                                                            const float* __restrict direction,
                                                            std::size_t size, float* __restrict out) {
    for (std::size_t i = 0; i < size; ++i, direction += 3, out += 3) {
      const auto r = static_cast<float>(range[i]);
      out[0] = r * direction[0];
      out[1] = r * direction[1];
      out[2] = r * direction[2];
    }
  }

  static constexpr std::size_t table = 131072;
  std::vector<std::int32_t> ranges_ = std::vector<std::int32_t>(table, 5000);
  std::vector<float> directions_ = std::vector<float>(3 * table, 1e-3f);
  std::vector<float> out_ = std::vector<float>(3 * table, 0.0f);
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
    std::printf("%-47s %9s %9s %9s %8s %8s\n", "ns per return, medians", "decode", "floor", "memcpy",
                "x floor", "% core");
  }
  std::vector<Stream> streams;
  const auto wanted = [&](const std::string& name) { return name.find(options.only) != std::string::npos; };
  for (const char* profile :
       {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8"}) {
    for (const bool all_fields : {false, true}) {
      const std::string name = std::string("OS0-128 ") + profile + (all_fields ? ", all fields" : "");
      if (wanted(name)) streams.push_back(ouster_stream(name, profile, all_fields));
    }
  }
  for (const char* name : {"VLP-16", "HDL-32E", "VLP-32C", "HDL-64E-nominal", "VLS-128"}) {
    if (wanted(name)) streams.push_back(velodyne_stream(name));
  }
  Floor least_loop;
  for (const Stream& stream : streams) {
    std::vector<double> decode, least, copy, ratios;
    std::size_t points = 0;
    const auto per_point = [&](double ns) { return ns / static_cast<double>(points); };
    for (int i = 0; i < options.repeats; ++i) {
      decode.push_back(per_point(decode_once(stream, points)));
      least.push_back(per_point(least_loop.once(stream.pixels)));
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
