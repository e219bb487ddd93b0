#include "drivers/lidar/ouster/decoder.h"

namespace ca2 {

OusterDecoder::OusterDecoder(const OusterMetadata& metadata, OusterOptions options)
    : format_(make_ouster_format(metadata)),
      init_id_(metadata.init_id),
      serial_(metadata.serial),
      geometry_(make_ouster_geometry(metadata)),
      options_(std::move(options)),
      assembler_(metadata, options_.extra_fields) {}

/// A 0 on either side means "not known": old firmware sends neither, reduced metadata has neither.
bool OusterDecoder::ours(const OusterPacketHeader& header, LidarCounters& counters) const {
  if (header.serial != 0 && serial_ != 0 && header.serial != serial_) {
    ++counters.other_sensor;
    return false;
  }
  if (header.init_id != 0 && init_id_ != 0 && header.init_id != init_id_) {
    ++counters.reinitialised;
    return false;
  }
  return true;
}

void OusterDecoder::push(const Datagram& datagram, LidarCounters& counters, const LidarSink& sink) {
  switch (classify_ouster_packet(format_, datagram.payload)) {
    case OusterPacketKind::imu:
      ++counters.imu_packets;
      return;
    case OusterPacketKind::zone:
      ++counters.zone_packets;
      return;
    case OusterPacketKind::wrong_size:
      ++counters.wrong_size;
      return;
    case OusterPacketKind::wrong_type:
      ++counters.wrong_type;
      return;
    case OusterPacketKind::lidar:
      break;
  }
  const OusterPacketHeader header = read_ouster_header(format_, datagram.payload);
  if (!ours(header, counters)) return;
  if (!ouster_checksum_fits(format_, datagram.payload)) {
    ++counters.checksum_errors;
    return;
  }
  assembler_.push(datagram.payload, header.frame_id, datagram.time, counters,
                  [&](const OusterFrame& frame) { give_out(frame, sink); });
}

void OusterDecoder::flush(LidarCounters& counters, const LidarSink& sink) {
  assembler_.flush(counters, [&](const OusterFrame& frame) { give_out(frame, sink); });
}

void OusterDecoder::give_out(const OusterFrame& frame, const LidarSink& sink) {
  if (options_.frame_sink) options_.frame_sink(frame);
  reuse(scan_);
  make_scan(frame, geometry_, options_.second_returns, options_.exact, scan_);
  scan_.frame_id = frame.frame_id;
  scan_.complete = frame.missing_packets == 0;
  scan_.missing_packets = frame.missing_packets;
  scan_.clock = frame.clock;
  sink(std::move(scan_));
}

}  // namespace ca2
