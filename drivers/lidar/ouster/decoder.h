/// @file The Ouster family's decoder: which packets are this sensor's, and frames to scans.
#pragma once

#include <functional>

#include "drivers/lidar/ouster/frame_assembler.h"
#include "drivers/lidar/packet_decoder.h"

namespace ca2 {

struct OusterOptions {
  bool second_returns = true;  ///< of dual return profiles, into the scan
  bool exact = false;          ///< give LidarScan::exact
  bool extra_fields = false;   ///< decode signal and near infrared for `frame_sink`
  /// Also sees every frame with all its fields.
  std::function<void(const OusterFrame&)> frame_sink;
};

class OusterDecoder : public PacketDecoder {
 public:
  explicit OusterDecoder(const OusterMetadata& metadata, OusterOptions options = {});

  void push(const Datagram& datagram, LidarCounters& counters, const LidarSink& sink) override;
  void flush(LidarCounters& counters, const LidarSink& sink) override;

 private:
  bool ours(const OusterPacketHeader& header, LidarCounters& counters) const;
  void give_out(const OusterFrame& frame, const LidarSink& sink);

  OusterFormat format_;
  std::uint32_t init_id_;
  std::uint64_t serial_;
  OusterGeometry geometry_;
  OusterOptions options_;
  OusterFrameAssembler assembler_;
  LidarScan scan_;
};

}  // namespace ca2
