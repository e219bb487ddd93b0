#include "drivers/lidar/lidar_driver.h"

#include <cmath>
#include <numbers>

#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/decoder.h"
#include "drivers/lidar/velodyne/decoder.h"

namespace ca2 {
namespace {

Result<std::unique_ptr<PacketDecoder>> open_ouster(const OusterMetadata& metadata,
                                                   const LidarDriverOptions& options) {
  if (metadata.profile == "OFF") {
    return fail(ErrorCode::config, "",
                "the metadata says udp_profile_lidar OFF: the sensor sends no LiDAR packets",
                "switch them on, e.g. RNG19_RFL8_SIG16_NIR16");
  }
  OusterOptions ouster;
  ouster.second_returns = options.second_returns;
  ouster.exact = options.exact;
  return std::unique_ptr<PacketDecoder>(std::make_unique<OusterDecoder>(metadata, std::move(ouster)));
}

Result<std::unique_ptr<PacketDecoder>> open_velodyne(const LidarModel& model, const LidarModelSpec& spec,
                                                     const LidarDriverOptions& options) {
  const VelodyneModel& velodyne = *model.velodyne();
  std::optional<VelodyneCalibration> known;
  const bool streamed =
      options.streamed_calibration && spec.calibration.empty() && velodyne.factory.lasers.empty();
  if (!streamed) {
    Result<VelodyneCalibration> calibration = velodyne_calibration(velodyne, model.name, spec.calibration);
    if (!calibration) return fail(calibration.error());
    known = std::move(*calibration);
  }
  VelodyneOptions out;
  out.second_returns = options.second_returns;
  out.exact = options.exact;
  const double turns = options.cut_azimuth / (2 * std::numbers::pi);
  out.cut_azimuth =
      static_cast<int>(std::lround((turns - std::floor(turns)) * VelodynePacket::azimuth_turn)) %
      VelodynePacket::azimuth_turn;
  out.azimuth = options.azimuth;
  out.two_point_correction = options.two_point_correction;
  return std::unique_ptr<PacketDecoder>(std::make_unique<VelodyneDecoder>(velodyne, known, out));
}

}  // namespace

LidarDriver::LidarDriver(std::string model, const LidarDriverOptions& options,
                         std::unique_ptr<PacketDecoder> decoder)
    : model_(std::move(model)),
      source_address_(options.source_address),
      one_source_(options.one_source),
      decoder_(std::move(decoder)) {}

Result<LidarDriver> LidarDriver::open(const LidarModelSpec& spec, const LidarDriverOptions& options) {
  std::string name;
  Result<std::unique_ptr<PacketDecoder>> decoder = nullptr;
  if (!spec.metadata.empty()) {
    const Result<OusterMetadata> metadata = read_ouster_metadata(spec.metadata);
    if (!metadata) return fail(metadata.error());
    name = metadata->prod_line.empty() ? "Ouster" : metadata->prod_line;
    decoder = open_ouster(*metadata, options);
  } else {
    const Result<const LidarModel*> model = find_lidar_model(spec.model);
    if (!model) return fail(model.error());
    name = (*model)->name;
    if ((*model)->ouster()) {
      return fail(ErrorCode::config, "", "packets of an " + name + " cannot be decoded without its metadata",
                  "give the JSON from the sensor's http://SENSOR/api/v1/sensor/metadata");
    }
    decoder = open_velodyne(**model, spec, options);
  }
  if (!decoder) return fail(decoder.error());
  return LidarDriver(name, options, std::move(*decoder));
}

void LidarDriver::push(const Datagram& datagram, const LidarSink& sink) {
  ++counters_.datagrams;
  if (!source_address_.empty() && datagram.source_address != source_address_) {
    ++counters_.other_source;
    return;
  }
  if (datagram.truncated) {
    ++counters_.truncated;
    return;
  }
  const bool undecided = one_source_ && source_address_.empty();
  const LidarCounters before = undecided ? counters_ : LidarCounters{};
  decoder_->push(datagram, counters_, sink);
  // A packet that fits is counted at once, or not at all while it waits for its turn.
  if (undecided && (counters_.lidar_packets > before.lidar_packets || counters_ == before)) {
    source_address_ = datagram.source_address;
    found_source_ = true;
  }
}

void LidarDriver::flush(const LidarSink& sink) {
  decoder_->flush(counters_, sink);
}

}  // namespace ca2
