/// @file A Velodyne packet, from bytes. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "drivers/lidar/bytes.h"
#include "drivers/lidar/velodyne/velodyne_model.h"

namespace ca2 {

/// Offsets and sizes of the data packet every model sends (VLP-16 User Manual, section 9).
struct VelodynePacket {
  static constexpr std::size_t bytes = 1206;
  static constexpr std::size_t position_bytes = 512;
  static constexpr int blocks = 12;
  static constexpr int channels = 32;
  static constexpr std::size_t block_bytes = 100;
  static constexpr int azimuth_turn = 36000;  ///< azimuths count 0.01 degree

  static const std::uint8_t* block(const std::uint8_t* packet, int index) {
    return packet + static_cast<std::size_t>(index) * block_bytes;
  }
  static std::uint16_t flag(const std::uint8_t* block) { return load<std::uint16_t>(block); }
  static std::uint16_t azimuth(const std::uint8_t* block) { return load<std::uint16_t>(block + 2); }
  static std::uint16_t distance(const std::uint8_t* block, int channel) {
    return load<std::uint16_t>(block + 4 + 3 * channel);
  }
  static std::uint8_t intensity(const std::uint8_t* block, int channel) { return block[6 + 3 * channel]; }
  /// us since the top of the hour.
  static std::uint32_t timestamp(const std::uint8_t* packet) { return load<std::uint32_t>(packet + 1200); }
  static std::uint8_t return_mode(const std::uint8_t* packet) { return packet[1204]; }
  static std::uint8_t product_id(const std::uint8_t* packet) { return packet[1205]; }

  static constexpr std::uint16_t bank_flags[4] = {0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};
  static constexpr std::uint8_t mode_strongest = 0x37, mode_last = 0x38, mode_dual = 0x39,
                                mode_dual_confidence = 0x3B;
};

/// First laser of the bank a block carries; -1 for an unknown flag.
int velodyne_bank(std::uint16_t flag);

/// One firing of all lasers (of a quarter of them with an HDL-64E S1, whose banks fire apart); the two of a
/// block with a VLP-16, one cycle after the other.
struct VelodyneFiring {
  int azimuth = 0;  ///< 0.01 degree, at the start of the firing
  int cycle = 0;    ///< firing cycles after the packet's first
  /// 0.01 degree that the head turns from this block to the next in time, by bank; 0: not to be told.
  std::array<double, 4> step{};
  bool rounded = false;  ///< the lasers' azimuths are rounded to 0.01 degree
  /// 0.01 degree from this block's azimuth to that of all lasers' strongest returns; VelodyneAzimuth::blocks.
  std::optional<int> strongest_ahead;
  /// Blocks by return (0: the one given out first) and bank; nullptr: not in the packet.
  std::array<std::array<const std::uint8_t*, 4>, 2> blocks{};
};

/// How a packet's blocks form firings.
struct VelodyneFirings {
  static constexpr std::size_t most = VelodynePacket::blocks;
  std::array<VelodyneFiring, most> firing;
  int count = 0;
  int bad_blocks = 0;
};

/// Arrangements of blocks.
enum class VelodyneLayout {
  single,
  pairs,    ///< last, strongest
  triples,  ///< last, strongest, confidence
  groups,   ///< HDL-64E: upper and lower strongest, upper and lower last
  apart,    ///< HDL-64E S1: every block at its own azimuth, no time stamp, firing times not published
};

/// Empty for a return mode with an unknown layout.
std::optional<VelodyneLayout> find_velodyne_layout(const VelodyneModel& model, const std::uint8_t* packet);

/// Firing cycles a whole packet of this layout spans.
int velodyne_cycles(const VelodyneModel& model, VelodyneLayout layout);

/// How far a laser's azimuth is from its block's.
enum class VelodyneAzimuth {
  /// By its firing time and the head's rate over the packet: where the beam was.
  times,
  /// As VeloView computes it: the same, with the packet's (upper) median step, rounded to 0.01 degree.
  veloview,
  /// By the step to the next block on the wire, as the ROS drivers compute it: blocks whose successor has the
  /// same azimuth, which are three of four of a VLS-128's, and the last pair of a dual return packet are left
  /// where they are, and the strongest returns of a VLP-16's pairs are put where the next pair begins. Up to
  /// 0.4 degree from `times`.
  blocks,
  /// As the published clouds of the model are made: `blocks` for a VLS-128 and for dual returns of a VLP-16,
  /// else `veloview`.
  published,
};

/// Sorts blocks into firings. Blocks with an unknown flag or an impossible azimuth are counted and left out.
/// What was in `out` is lost.
void read_velodyne_firings(const VelodyneModel& model, VelodyneLayout layout, VelodyneAzimuth azimuth,
                           const std::uint8_t* packet, VelodyneFirings& out);

/// True where the packet cannot be of this model: product id or laser banks of another one.
bool velodyne_other_model(const VelodyneModel& model, const std::uint8_t* packet);

}  // namespace ca2
