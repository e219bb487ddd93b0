#include <cstring>

#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/velodyne/decoder.h"
#include "drivers/lidar/velodyne/position.h"
#include "tests/fuzz/fuzz_packets.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

using P = VelodynePacket;

// First bytes of an input that is no stream of packets.
constexpr std::uint8_t position_packet = 0xFE, streamed_table = 0xFD;
// First bytes of the items of a stream. A short item says what the fuzzer should vary and is made a packet
// of: inputs of 44 bytes instead of 1206. A long one is any datagram, with two bytes of length.
constexpr std::uint8_t short_item = 0;
constexpr std::size_t short_bytes = 3 * P::blocks + 7;

std::vector<const LidarModel*> velodynes() {
  std::vector<const LidarModel*> out;
  for (const LidarModel& model : lidar_models()) {
    if (model.velodyne()) out.push_back(&model);
  }
  return out;
}

/// By block: which flag, azimuth; then time stamp, return mode, product id, and what all returns are.
std::string shortened(const std::uint8_t* packet) {
  std::string out(1, static_cast<char>(short_item));
  for (int b = 0; b < P::blocks; ++b) {
    const std::uint8_t* block = P::block(packet, b);
    out += static_cast<char>(velodyne_bank(P::flag(block)));
    out.append({static_cast<char>(block[2]), static_cast<char>(block[3])});
  }
  for (std::size_t i = 1200; i < P::bytes; ++i) out += static_cast<char>(packet[i]);
  return out + '\x12';
}

std::vector<std::uint8_t> lengthened(std::span<const std::uint8_t> item) {
  std::vector<std::uint8_t> packet(P::bytes, item.back());
  for (std::size_t b = 0; b < P::blocks; ++b) {
    std::uint8_t* block = packet.data() + b * P::block_bytes;
    const std::uint8_t bank = item[3 * b];
    store(block, bank < 4 ? P::bank_flags[bank] : static_cast<std::uint16_t>(bank));
    block[2] = item[3 * b + 1];
    block[3] = item[3 * b + 2];
  }
  std::memcpy(packet.data() + 1200, item.data() + 3 * P::blocks, 6);
  return packet;
}

/// A stream of items as the stream of packets that decode_all takes.
std::string all_lengthened(std::span<const std::uint8_t> items) {
  std::string out;
  while (!items.empty()) {
    const bool is_short = items[0] == short_item;
    items = items.subspan(1);
    if (is_short) {
      if (items.size() < short_bytes) break;
      append_packet(out, lengthened(items.first(short_bytes)));
      items = items.subspan(short_bytes);
    } else {
      const std::size_t wanted = items.size() < 2 ? 0 : items[0] + 256u * items[1];
      const std::size_t size = std::min(wanted + 2, items.size());
      out.append(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(size));
      items = items.subspan(size);
    }
  }
  return out;
}

void decode_stream(std::uint8_t choice, std::span<const std::uint8_t> items) {
  static const auto models = velodynes();
  const VelodyneModel& model = *models[choice % models.size()]->velodyne();
  // An HDL-64E without a table waits for its stream.
  std::optional<VelodyneCalibration> calibration;
  if (!model.factory.lasers.empty()) calibration = model.factory;
  VelodyneOptions options;
  options.exact = true;
  options.azimuth = choice & 0x80 ? VelodyneAzimuth::blocks : VelodyneAzimuth::times;
  options.two_point_correction = (choice & 0x40) != 0;
  VelodyneDecoder decoder(model, calibration, options);
  const std::string packets = all_lengthened(items);
  decode_all(decoder, {reinterpret_cast<const std::uint8_t*>(packets.data()), packets.size()});
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> out;
  const auto models = velodynes();
  for (std::size_t i = 0; i < models.size(); ++i) {
    const VelodyneModel& model = *models[i]->velodyne();
    if (model.factory.lasers.empty()) continue;
    for (const std::uint8_t mode : {std::uint8_t{0x37}, std::uint8_t{0x39}}) {
      EncoderScan scan;
      scan.rings = model.lasers;
      scan.columns = 96;
      scan.range[0].assign(static_cast<std::size_t>(model.lasers) * 96u, 10.0f);
      scan.azimuth = 0.999;
      VelodyneEncoder encoder(model, model.factory, {mode, 0, 20});
      std::string text(1, static_cast<char>(i));
      int packets = 0;
      for (const EncodedPacket& packet : encoder.push(scan)) {
        if (packets++ < 3) text += shortened(packet.bytes.data());
      }
      out.push_back(text);
    }
  }
  std::string position(1, static_cast<char>(position_packet));
  position += "$GPRMC,214106,A,3707.8178,N,12139.2690,W,000.0,000.0,230715,013.8,E*6A\r\n";
  out.push_back(position);
  const auto table = write_streamed_calibration((*find_lidar_model("HDL-64E-nominal"))->velodyne()->factory);
  out.push_back(std::string(1, static_cast<char>(streamed_table)) + std::string(table.begin(), table.end()));
  return out;
}

}  // namespace ca2::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  if (size == 0) return 0;
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  if (data[0] == fuzz::position_packet) {
    std::array<std::uint8_t, VelodynePacket::position_bytes> packet{};
    constexpr std::size_t sentence = 206;
    std::memcpy(packet.data() + sentence, rest.data(), std::min(rest.size(), packet.size() - sentence));
    parse_velodyne_position(packet);
  } else if (data[0] == fuzz::streamed_table) {
    parse_streamed_calibration(rest.first(std::min(rest.size(), StreamedCalibration::table_bytes)));
  } else {
    fuzz::decode_stream(data[0], rest);
  }
  return 0;
}
