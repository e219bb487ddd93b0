/// @file The one path from datagrams to scans, live and replayed.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drivers/lidar/beam_table.h"
#include "drivers/lidar/counters.h"
#include "drivers/lidar/lidar_scan.h"
#include "drivers/lidar/packet_decoder.h"
#include "drivers/lidar/velodyne/packet.h"

namespace ca2 {

struct LidarDriverOptions {
  /// Only datagrams from this address, as Datagram spells it; empty: from any. Needed where two sensors
  /// without serial numbers in their packets share a port.
  std::string source_address;
  /// Without a source_address: the one whose packet is the first that fits is the sensor's from then on. For
  /// files, where a second sensor's packets would be woven into its scans.
  bool one_source = false;
  bool second_returns = true;  ///< of dual return modes, into the scan
  bool exact = false;          ///< give LidarScan::exact
  double cut_azimuth = 0;      ///< rad, Velodyne: where a scan begins, clockwise from +y
  /// HDL-64E without a calibration file: take the one S2 and S3 stream in their packets. Until it has come
  /// whole (seconds), packets are counted as waiting_for_calibration.
  bool streamed_calibration = false;
  VelodyneAzimuth azimuth = VelodyneAzimuth::times;  ///< Velodyne: where lasers look within a block
  bool two_point_correction = false;  ///< HDL-64E: the manual's correction below 25 m (velodyne/projection.h)
};

/// Scans come out in the order of their frames; the same datagrams give the same scans, bit for bit.
class LidarDriver {
 public:
  /// Metadata makes it an Ouster; otherwise `model` says which Velodyne. Errors as make_beam_table's.
  static Result<LidarDriver> open(const LidarModelSpec& spec, const LidarDriverOptions& options = {});

  void push(const Datagram& datagram, const LidarSink& sink);
  /// Gives out the scan under way: the end of a recording.
  void flush(const LidarSink& sink);

  /// False while the calibration is still being collected from the stream.
  bool ready() const { return decoder_->ready(); }
  const LidarCounters& counters() const { return counters_; }
  /// The only one that is listened to; empty: any.
  const std::string& source_address() const { return source_address_; }
  /// Was it the first that fitted (LidarDriverOptions::one_source), not one that was asked for?
  bool found_source() const { return found_source_; }
  /// Forgets the counts, e.g. to read a recording again after its calibration was collected.
  void reset_counters() { counters_ = {}; }
  const std::string& model() const { return model_; }  ///< "VLP-16", or an Ouster's product line

 private:
  LidarDriver(std::string model, const LidarDriverOptions& options, std::unique_ptr<PacketDecoder> decoder);

  std::string model_;
  std::string source_address_;
  bool one_source_;
  bool found_source_ = false;
  std::unique_ptr<PacketDecoder> decoder_;
  LidarCounters counters_;
};

}  // namespace ca2
