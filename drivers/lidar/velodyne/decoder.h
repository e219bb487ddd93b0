/// @file The Velodyne family's decoder: packets to firings to revolutions.
#pragma once

#include <optional>

#include "drivers/lidar/packet_decoder.h"
#include "drivers/lidar/velodyne/packet_order.h"
#include "drivers/lidar/velodyne/packet_pace.h"
#include "drivers/lidar/velodyne/projection.h"
#include "drivers/lidar/velodyne/scan_cutter.h"
#include "drivers/lidar/velodyne/streamed_calibration.h"

namespace ca2 {

struct VelodyneOptions {
  bool second_returns = true;
  bool exact = false;   ///< give LidarScan::exact
  int cut_azimuth = 0;  ///< 0.01 degree
  VelodyneAzimuth azimuth = VelodyneAzimuth::times;
  bool two_point_correction = false;
};

class VelodyneDecoder : public PacketDecoder {
 public:
  /// Without a calibration, one is collected from the packets first (HDL-64E S2 and S3 stream theirs).
  VelodyneDecoder(const VelodyneModel& model, const std::optional<VelodyneCalibration>& calibration,
                  const VelodyneOptions& options);

  void push(const Datagram& datagram, LidarCounters& counters, const LidarSink& sink) override;
  void flush(LidarCounters& counters, const LidarSink& sink) override;
  bool ready() const override { return projection_.has_value(); }

 private:
  void use(const VelodyneCalibration& calibration);
  void take(const OrderedPacket& packet, VelodyneLayout layout, LidarCounters& counters,
            const LidarSink& sink);
  void measure_cycle(const OrderedPacket& packet, int cycles);
  void give_out(LidarCounters& counters, const LidarSink& sink, bool whole);

  VelodyneModel model_;
  VelodyneOptions options_;
  std::optional<VelodyneProjection> projection_;
  StreamedCalibration streamed_;
  VelodynePacketPace pace_;
  VelodynePacketOrder order_;
  VelodyneScanCutter cutter_;

  VelodyneFirings firings_;           ///< of the current packet
  double cycle_;                      ///< s, the model's or as measured
  std::int64_t measured_time_ = 0;    ///< ns between packets that followed each other ...
  std::int64_t measured_cycles_ = 0;  ///< ... and the cycles in them
  std::optional<OrderedPacket> last_;
  int last_cycles_ = 0;   ///< of the last packet
  int last_azimuth_ = 0;  ///< 0.01 degree, of its first firing
  double step_;           ///< 0.01 degree per cycle

  LidarScan scan_;
  ReturnWriter writer_;             ///< of scan_
  std::int64_t firing_number_ = 0;  ///< of the current packet's first firing, since the start
  std::int64_t scan_first_ = 0;     ///< number of the firing that has column 0
  bool begun_at_cut_ = false;
  std::uint32_t scan_count_ = 0;
};

}  // namespace ca2
