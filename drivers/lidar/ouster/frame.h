/// @file One revolution of an Ouster: every field of every pixel, as the sensor sent it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types/scan.h"
#include "drivers/lidar/lidar_scan.h"
#include "drivers/lidar/ouster/geometry.h"

namespace ca2 {

/// Staggered as measured: place [column * rows + row], column = measurement id. Columns that never came, or
/// that the sensor marked invalid, are 0 in every array. Fields the profile lacks are empty.
struct OusterFrame {
  int rows = 0;
  int columns = 0;
  std::uint32_t frame_id = 0;
  int packets = 0;          ///< received
  int missing_packets = 0;  ///< of those the column window lets expect
  std::vector<ClockSample> clock;

  std::vector<std::uint64_t> timestamp;       ///< ns, sensor's clock, by column
  std::vector<std::uint32_t> status;          ///< as on the wire, by column; 0: not there
  std::vector<std::uint16_t> measurement_id;  ///< by column
  std::vector<std::uint32_t> range[2];        ///< mm; 0: no return
  std::vector<std::uint8_t> reflectivity[2];
  std::vector<std::uint16_t> signal[2];
  std::vector<std::uint16_t> near_ir;
};

/// The returns of a frame as points. Order: by column, then return (the strongest first, as the sensor
/// is set up by default), then row. Intensity is the calibrated reflectivity, which every profile has; time
/// is the column's, on the sensor's clock. Sets `scan` and, when asked for, `exact` of `out`, which was made
/// ready by reuse().
void make_scan(const OusterFrame& frame, const OusterGeometry& geometry, bool second_returns, bool exact,
               LidarScan& out);

}  // namespace ca2
