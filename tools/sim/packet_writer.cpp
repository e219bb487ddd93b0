#include "tools/sim/packet_writer.h"

#include <cmath>

#include "core/io/files.h"
#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/net/pcap_writer.h"
#include "tools/sim/lidar_sequence.h"

namespace ca2 {
namespace {

// What a network and a kernel take from the sensor's sending to the time stamp.
constexpr std::int64_t latency = 150'000;  // ns
constexpr std::string_view profile = "RNG19_RFL8_SIG16_NIR16";

/// The metadata that the scenario names, or a simulated unit's.
Result<OusterMetadata> metadata_of(const ScenarioFile& scenario, const RigLidar& lidar,
                                   const BeamTable& beams) {
  if (!lidar.metadata.empty()) return read_ouster_metadata(scenario.file.parent_path() / lidar.metadata);
  const Result<const LidarModel*> model = find_lidar_model(lidar.model);
  if (!model) return fail(model.error());
  return nominal_ouster_metadata(*(*model)->ouster(), beams.columns, beams.rate, profile);
}

bool is_ouster(const RigLidar& lidar) {
  if (!lidar.metadata.empty()) return true;
  const Result<const LidarModel*> model = find_lidar_model(lidar.model);
  return model && (*model)->ouster() != nullptr;
}

class PacketFile {
 public:
  PacketFile(PcapWriter writer, std::string source, std::uint16_t port)
      : writer_(std::move(writer)), source_(std::move(source)), port_(port) {}

  Result<void> write(const std::vector<EncodedPacket>& packets) {
    for (const EncodedPacket& packet : packets) {
      Datagram datagram;
      datagram.time = packet.time + latency;
      datagram.source_address = source_;
      datagram.source_port = datagram.destination_port = port_;
      datagram.payload = packet.bytes;
      if (auto written = writer_.write(datagram); !written) return written;
    }
    return {};
  }
  Result<void> close() { return writer_.close(); }

 private:
  PcapWriter writer_;
  std::string source_;
  std::uint16_t port_;
};

Result<void> write_ouster(const OusterMetadata& metadata, LidarSequence& sequence, double duration,
                          std::int64_t start, PacketFile& file) {
  const double period = 1 / metadata.rate;
  for (std::uint32_t frame = 0; (frame + 1) * period <= duration; ++frame) {
    EncoderScan scan = sequence.scan(frame * period, 0);
    scan.start = start + std::llround(1e9 * frame * period);
    scan.frame_id = frame + 1;
    if (auto written = file.write(encode_ouster(metadata, scan)); !written) return written;
  }
  return {};
}

Result<void> write_velodyne(const VelodyneModel& model, const VelodyneCalibration& calibration,
                            const BeamTable& beams, LidarSequence& sequence, double duration,
                            std::int64_t start, PacketFile& file) {
  VelodyneEncoding encoding;
  encoding.rate = beams.rate;
  VelodyneEncoder encoder(model, calibration, encoding);
  // A sweep of the table is a little less than a revolution: firings do not fit into it evenly.
  const double sweep = beams.columns * model.cycle;
  double azimuth = 0;
  for (int i = 0; (i + 1) * sweep <= duration; ++i) {
    EncoderScan scan = sequence.scan(i * sweep, azimuth);
    scan.start = start + std::llround(1e9 * i * sweep);
    if (auto written = file.write(encoder.push(scan)); !written) return written;
    azimuth += sweep * beams.rate;
  }
  return file.write(encoder.flush());
}

}  // namespace

Result<void> carry_lidar_files(const ScenarioFile& scenario, const std::string& name,
                               const std::filesystem::path& directory, RigLidar& described) {
  const BeamTable& beams = scenario.scenario.lidars.at(name).beams;
  if (is_ouster(described)) {
    const Result<OusterMetadata> metadata = metadata_of(scenario, described, beams);
    if (!metadata) return fail(metadata.error());
    described.metadata = "lidars/" + name + ".json";
    described.model.clear();
    return write_atomically(directory / described.metadata, write_ouster_metadata(*metadata));
  }
  if (described.calibration.empty()) return {};
  const std::filesystem::path source = scenario.file.parent_path() / described.calibration;
  const Result<std::string> content = read_text(source);
  if (!content) return fail(content.error());
  described.calibration = "lidars/" + name + source.extension().string();
  return write_atomically(directory / described.calibration, *content);
}

Result<void> write_packets(const ScenarioFile& scenario, const std::string& name, const Scene& room,
                           const PersonMotion& motion, std::int64_t start,
                           const std::filesystem::path& directory) {
  const SimulatedLidar& lidar = scenario.scenario.lidars.at(name);
  const RigLidar& described = scenario.rig.lidars.at(name);
  const bool ouster = is_ouster(described);
  auto writer = PcapWriter::create(directory / "lidars" / (name + ".pcap"));
  if (!writer) return fail(writer.error());
  // Addresses of the documentation block (RFC 5737).
  PacketFile file(std::move(*writer), "192.0.2.10", ouster ? 7502 : 2368);
  const auto& lidars = scenario.scenario.lidars;
  const auto index = std::distance(lidars.begin(), lidars.find(name));
  std::seed_seq seeds{static_cast<std::uint32_t>(scenario.scenario.seed), static_cast<std::uint32_t>(index),
                      0x11DAu};
  std::mt19937_64 rng(seeds);
  LidarSequence sequence(
      lidar, room, [&](Scene& scene, double time) { motion.add_to(scene, time); }, rng());
  Result<void> written;
  if (ouster) {
    const Result<OusterMetadata> metadata = metadata_of(scenario, described, lidar.beams);
    if (!metadata) return fail(metadata.error());
    written = write_ouster(*metadata, sequence, motion.duration(), start, file);
  } else {
    const Result<const LidarModel*> model = find_lidar_model(described.model);
    if (!model) return fail(model.error());
    const VelodyneModel& velodyne = *(*model)->velodyne();
    const auto calibration = velodyne_calibration(velodyne, (*model)->name,
                                                  described.calibration.empty()
                                                      ? std::filesystem::path()
                                                      : scenario.file.parent_path() / described.calibration);
    if (!calibration) return fail(calibration.error());
    written = write_velodyne(velodyne, *calibration, lidar.beams, sequence, motion.duration(), start, file);
  }
  if (!written) return written;
  return file.close();
}

}  // namespace ca2
