#include <algorithm>

#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/decoder.h"
#include "drivers/lidar/ouster/profile.h"
#include "tests/fuzz/fuzz_packets.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

/// As small as a sensor can be, of every packet format: speed is executions.
constexpr int beams = 4, columns = 16;

/// The first byte of an input chooses the packet format and the column window.
const OusterMetadata& sensor(std::size_t choice) {
  static const std::vector<OusterMetadata> sensors = [] {
    OusterModel model = *(*find_lidar_model("OS1-16"))->ouster();
    model.beams = beams;
    std::vector<OusterMetadata> out;
    for (const OusterProfile& profile : ouster_profiles()) {
      OusterMetadata metadata = nominal_ouster_metadata(model, columns, 10, profile.name);
      metadata.columns_per_packet = 4;
      out.push_back(metadata);
      metadata.window_first = 14;
      metadata.window_last = 5;
      out.push_back(metadata);
    }
    return out;
  }();
  return sensors[choice % sensors.size()];
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> out;
  for (std::size_t choice = 0; choice < 2 * ouster_profiles().size(); ++choice) {
    EncoderScan scan;
    scan.rings = beams;
    scan.columns = columns;
    scan.range[0].assign(beams * columns, 10.0f);
    scan.range[1].assign(beams * columns, 12.0f);
    std::string text(1, static_cast<char>(choice));
    for (scan.frame_id = 65535; scan.frame_id <= 65536; ++scan.frame_id) {
      for (EncodedPacket& packet : encode_ouster(sensor(choice), scan)) {
        // Without a checksum, as older firmware sends it: a mutation would only be told from the checksum.
        if (scan.frame_id % 2 == 0 && !sensor(choice).profile.starts_with("LEGACY")) {
          std::fill(packet.bytes.end() - 8, packet.bytes.end(), std::uint8_t{0});
        }
        append_packet(text, packet.bytes);
      }
    }
    out.push_back(text);
  }
  return out;
}

}  // namespace ca2::fuzz

/// Whatever arrives, scans are whole and what is not understood is counted.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  if (size == 0) return 0;
  OusterOptions options;
  options.exact = options.extra_fields = true;
  OusterDecoder decoder(fuzz::sensor(data[0]), options);
  fuzz::decode_all(decoder, {data + 1, size - 1});
  return 0;
}
