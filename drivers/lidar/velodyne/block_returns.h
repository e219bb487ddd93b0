/// @file The returns of a Velodyne's block as points, for every kind of processor.
#pragma once

#include <cstddef>

#include "drivers/lidar/return_writer.h"
#include "drivers/lidar/velodyne/projection.h"

namespace ca2::detail {

/// What a block's points follow from, besides its distances.
struct VelodyneBlockPlace {
  float sine, cosine;  ///< of where the head looks
  const VelodyneProjection::Turned& turned;
  const VelodyneProjection::Bank& bank;
  float lsb;      ///< m per count
  bool sideways;  ///< some laser has a horizontal offset
};

// In single precision: within 4e-7 of the range, 40 um at 100 m, where the wire's step is 2 mm. Lasers
// without a return are computed too.

void project_velodyne_block(const VelodyneProjection::Block& block, const VelodyneBlockPlace& place,
                            int lasers, FiredBeams& out);

#if defined(__x86_64__)
/// The same numbers of the channels that `names` names, from its `first` on, read from the block's bytes and
/// written in the same step as write_returns_portable() writes; only where has_avx512(). `names` needs
/// neither counts nor intensities; its beams are sixteen or 32. Reads four bytes beyond the last channel,
/// which a packet has after its last block.
std::size_t write_velodyne_block_avx512(const std::uint8_t* block, const VelodyneBlockPlace& place,
                                        const FiredNames& names, const ReturnTargets& out, std::size_t at);
#endif

}  // namespace ca2::detail
