/// @file What tells one Velodyne from another: constants, no code.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/lidar/velodyne/calibration.h"

namespace ca2 {

/// How dual returns lie in the blocks of a packet.
enum class VelodyneDual {
  pairs,   ///< blocks 2k and 2k+1: last, strongest
  groups,  ///< HDL-64E: upper, lower, upper, lower: strongest first, then last
};

struct VelodyneModel {
  int lasers = 0;
  std::vector<std::uint8_t> product_ids;  ///< byte 1205; empty: the format has none there (HDL-64E)
  double distance_lsb = 0;                ///< m per count
  double cycle = 0;                       ///< s from one firing of all lasers to the next
  std::vector<double> firing;             ///< s after the start of its cycle, by laser id
  double epoch = 0;                    ///< s from the packet's time stamp to the first firing (VLS-128: < 0)
  bool cycle_from_timestamps = false;  ///< the cycle differs with firmware: measured from the packets
  VelodyneDual dual = VelodyneDual::pairs;
  double min_range = 0, max_range = 0;  ///< m
  VelodyneCalibration factory;          ///< no lasers: every unit has its own file

  int blocks_per_firing() const { return lasers <= 32 ? 1 : lasers / 32; }
  int firings_per_block() const { return lasers >= 32 ? 1 : 32 / lasers; }
};

/// A calibration of angles only. `degrees` has (elevation, rotation) by laser id.
struct VelodyneAngles {
  double vertical;
  double rotation;
};
VelodyneCalibration velodyne_factory_table(const std::vector<VelodyneAngles>& degrees);

}  // namespace ca2
