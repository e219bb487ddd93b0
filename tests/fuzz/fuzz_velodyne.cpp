#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/velodyne/decoder.h"
#include "drivers/lidar/velodyne/position.h"
#include "tests/fuzz/fuzz_packets.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

std::vector<const LidarModel*> velodynes() {
  std::vector<const LidarModel*> out;
  for (const LidarModel& model : lidar_models()) {
    if (model.velodyne()) out.push_back(&model);
  }
  return out;
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
      scan.azimuth = 0.98;
      VelodyneEncoder encoder(model, model.factory, {mode, 0, 20});
      std::string text(1, static_cast<char>(i));
      int packets = 0;
      for (const EncodedPacket& packet : encoder.push(scan)) {
        if (packets++ < 8) append_packet(text, packet.bytes);
      }
      out.push_back(text);
    }
  }
  return out;
}

}  // namespace ca2::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  if (size == 0) return 0;
  static const auto models = fuzz::velodynes();
  const VelodyneModel& model = *models[data[0] % models.size()]->velodyne();
  // An HDL-64E without a table waits for its stream.
  std::optional<VelodyneCalibration> calibration;
  if (!model.factory.lasers.empty()) calibration = model.factory;
  VelodyneOptions options;
  options.exact = true;
  options.azimuth = data[0] & 0x80 ? VelodyneAzimuth::blocks : VelodyneAzimuth::times;
  options.two_point_correction = (data[0] & 0x40) != 0;
  VelodyneDecoder decoder(model, calibration, options);
  fuzz::decode_all(decoder, {data + 1, size - 1});
  if (size > 512) parse_velodyne_position({data + 1, 512});
  parse_streamed_calibration({data + 1, std::min<std::size_t>(size - 1, StreamedCalibration::table_bytes)});
  return 0;
}
