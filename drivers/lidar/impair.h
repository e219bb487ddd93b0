/// @file What a network does to packets, on purpose.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "drivers/lidar/encode.h"

namespace ca2 {

struct Impairment {
  double loss = 0;          ///< share of packets that never arrive
  double duplication = 0;   ///< share of the others that arrive twice, the copy right after
  std::size_t reorder = 0;  ///< packets are shuffled within windows of so many; 0, 1: in order
};

/// Packets as they would arrive; their times stay those of their arrival in order.
std::vector<EncodedPacket> impair(const std::vector<EncodedPacket>& packets, const Impairment& impairment,
                                  std::mt19937_64& random);

}  // namespace ca2
