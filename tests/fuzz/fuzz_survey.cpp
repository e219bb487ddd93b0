/// @file Datagrams of any sender. They are long and mostly zeros, so an input has what is not: three bytes of
/// the length and the number of others, then two of place and one of value each.
#include <algorithm>

#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/survey/survey.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

constexpr std::size_t most_bytes = 33024;  // an Ouster's of 128 beams fits

std::string shortened(const std::vector<std::uint8_t>& packet) {
  std::string values;
  int count = 0;
  for (std::size_t at = 0; at < packet.size() && count < 255; ++at) {
    if (packet[at] == 0) continue;
    values += {static_cast<char>(at & 0xFF), static_cast<char>(at >> 8), static_cast<char>(packet[at])};
    ++count;
  }
  return std::string{static_cast<char>(packet.size() & 0xFF), static_cast<char>(packet.size() >> 8),
                     static_cast<char>(count)} +
         values;
}

EncoderScan empty_scan(int rings, int columns) {
  EncoderScan scan;
  scan.rings = rings;
  scan.columns = columns;
  scan.range[0].assign(static_cast<std::size_t>(rings * columns), 0.0f);
  return scan;
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> out;
  std::string some;
  for (const char* name : {"VLP-16", "HDL-32E"}) {
    const VelodyneModel& model = *(*find_lidar_model(name))->velodyne();
    VelodyneEncoder encoder(model, model.factory, {0x37, 0, 20});
    int packets = 0;
    for (const EncodedPacket& packet : encoder.push(empty_scan(model.lasers, 96))) {
      if (packets++ < 3) some += shortened(packet.bytes);
    }
    out.push_back(some);
  }
  OusterModel model = *(*find_lidar_model("OS1-16"))->ouster();
  for (const char* profile : {"LEGACY", "RNG15_RFL8_NIR8"}) {
    const OusterMetadata metadata = nominal_ouster_metadata(model, 512, 10, profile);
    some.clear();
    for (const EncodedPacket& packet : encode_ouster(metadata, empty_scan(16, 512))) {
      if (some.size() < 2000) some += shortened(packet.bytes);
    }
    out.push_back(some);
  }
  std::vector<std::uint8_t> position(512), imu(48);
  position[206] = '$';
  imu[34] = 0x80, imu[35] = 0x3f;
  out.push_back(shortened(position) + shortened(imu));
  return out;
}

}  // namespace ca2::fuzz

/// Every datagram is counted once, in a stream that has a name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  Survey survey;
  std::span<const std::uint8_t> rest(data, size);
  std::uint64_t given = 0;
  while (rest.size() >= 3) {
    std::vector<std::uint8_t> packet((rest[0] + 256u * rest[1]) % fuzz::most_bytes);
    const std::size_t count = std::min<std::size_t>(rest[2], (rest.size() - 3) / 3);
    for (std::size_t i = 1; i <= count; ++i) {
      const std::size_t at = rest[3 * i] + 256u * rest[3 * i + 1];
      if (at < packet.size()) packet[at] = rest[3 * i + 2];
    }
    Datagram datagram;
    datagram.time = static_cast<std::int64_t>(++given) * 1'000'000;
    datagram.source_address = "192.0.2.7";
    datagram.payload = packet;
    survey.add(datagram);
    rest = rest.subspan(3 + 3 * count);
  }
  std::uint64_t counted = survey.unlisted();
  for (const StreamSummary& stream : survey.streams()) {
    counted += stream.datagrams;
    fuzz::require(!stream.identity.kind.empty(), "a stream without a name");
  }
  fuzz::require(counted == given, "datagrams are miscounted");
  return 0;
}
