/// @file The calibration that HDL-64E S2 and S3 send a byte at a time in their packets' status fields.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/lidar/velodyne/calibration.h"

namespace ca2 {

/// Collects a whole table (4160 packets, up to 2 s) and gives it once its checksum fits.
class StreamedCalibration {
 public:
  static constexpr std::size_t table_bytes = 1820;

  /// Bytes 1204 and 1205 of a packet; the calibration with the byte that completes it.
  std::optional<VelodyneCalibration> push(std::uint8_t type, std::uint8_t value);

  /// Packets are missing: what was collected has a hole.
  void lost() { bytes_.clear(); }

 private:
  std::vector<std::uint8_t> bytes_;  ///< from "UNIT#"
};

/// A table as streamed (S2 or S3); nothing when its checksum or laser numbers are wrong.
std::optional<VelodyneCalibration> parse_streamed_calibration(std::span<const std::uint8_t> table);

/// The table a sensor with this calibration streams (S3's checksum), rounded to the format's steps.
std::vector<std::uint8_t> write_streamed_calibration(const VelodyneCalibration& calibration);

}  // namespace ca2
