/// @file Stretches of rings that end at both sides within the board's size.
#pragma once

#include <vector>

#include "core/lidar/ring_image.h"

namespace ca2 {

/// Returns of one ring that follow one another without a jump in range.
struct RingRun {
  int row;
  int first, last;  ///< columns; `last` may be past the seam: wrap it
};

/// m in range per m across the ray that is still one surface: at 72 degrees of
/// incidence.
constexpr float kSteep = 3.0f;

/// What a run may be.
struct RunLimits {
  float jump;               ///< m, the least step in range that parts two surfaces
  float shortest, longest;  ///< m, from its first return to its last
};

/// The runs of an image that the board could have made, row by row: whatever
/// goes on beyond `longest` (walls, floors) is left out without a look at its
/// surface. One pass over the ranges.
void find_ring_runs(const RingImage& image, const RunLimits& limits, std::vector<RingRun>& runs);

}  // namespace ca2
