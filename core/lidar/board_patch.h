/// @file Does a planar piece look like the board? Its rectangle, its returns, and how sure that is.
#pragma once

#include <optional>

#include "core/board/board.h"
#include "core/lidar/board_candidate.h"
#include "core/lidar/planar_regions.h"
#include "core/lidar/ring_image.h"

namespace ca2 {

/// What is judged, and against what.
struct PatchContext {
  const Scan& scan;
  const Projection& projection;
  const RingImage& image;
  double width, height;  ///< m, the board
  double noise;          ///< m, of this scan
};

/// The board's rectangle laid over the piece, judged by what lies inside it (board), beyond its rim
/// (anything but more of the same plane) and by the plane's noise. None when it cannot be the board.
std::optional<BoardCandidate> judge_region(const PatchContext& context, const PlanarRegion& region);

}  // namespace ca2
