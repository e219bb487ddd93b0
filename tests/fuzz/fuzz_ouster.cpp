#include <memory>

#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/decoder.h"
#include "drivers/lidar/ouster/profile.h"
#include "tests/fuzz/fuzz_packets.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

/// A small sensor of every packet format: the first byte of an input chooses it.
OusterMetadata sensor(std::size_t profile, bool window) {
  const OusterModel& model = *(*find_lidar_model("OS1-16"))->ouster();
  const auto& profiles = ouster_profiles();
  OusterMetadata out = nominal_ouster_metadata(model, 32, 10, profiles[profile % profiles.size()].name);
  out.columns_per_packet = 4;
  if (window) {
    out.window_first = 27;
    out.window_last = 9;
  }
  return out;
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> out;
  for (std::size_t profile = 0; profile < ouster_profiles().size(); ++profile) {
    EncoderScan scan;
    scan.rings = 16;
    scan.columns = 32;
    scan.range[0].assign(16u * 32u, 10.0f);
    scan.range[1] = scan.range[0];
    std::string text(1, static_cast<char>(2 * profile));
    for (scan.frame_id = 7; scan.frame_id < 9; ++scan.frame_id) {
      for (const EncodedPacket& packet : encode_ouster(sensor(profile, false), scan))
        append_packet(text, packet.bytes);
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
  OusterDecoder decoder(fuzz::sensor(data[0] / 2, data[0] % 2 != 0), options);
  fuzz::decode_all(decoder, {data + 1, size - 1});
  return 0;
}
