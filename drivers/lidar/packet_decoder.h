/// @file What a family's decoder is to the driver: datagrams in, scans out, no clocks and no sockets.
#pragma once

#include "drivers/lidar/counters.h"
#include "drivers/lidar/lidar_scan.h"
#include "drivers/net/datagram.h"

namespace ca2 {

class PacketDecoder {
 public:
  PacketDecoder() = default;
  PacketDecoder(const PacketDecoder&) = delete;
  PacketDecoder& operator=(const PacketDecoder&) = delete;
  virtual ~PacketDecoder() = default;

  /// Never fails: what cannot be used is counted.
  virtual void push(const Datagram& datagram, LidarCounters& counters, const LidarSink& sink) = 0;

  /// Gives out what is under way; the next packet starts afresh.
  virtual void flush(LidarCounters& counters, const LidarSink& sink) = 0;

  /// False while packets are only searched for the calibration that decoding them needs (HDL-64E).
  virtual bool ready() const { return true; }
};

}  // namespace ca2
