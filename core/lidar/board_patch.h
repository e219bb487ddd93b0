/// @file Does a planar piece look like the board? Its rectangle, its returns,
/// and how sure that is.
#pragma once

#include <optional>

#include "core/lidar/board_candidate.h"
#include "core/lidar/outline_fit.h"
#include "core/lidar/planar_regions.h"

namespace ca2 {

/// How a rectangle is filled and how free its sides are, each 0..1.
struct Evidence {
  double fill = 0, free = 0, least_free = 0;
  int rows = 0;  ///< rings with returns on the board
};

/// The board's rectangle laid roughly over a piece.
struct FirstLook {
  Placed placed;
  Evidence evidence;
  double margin;  ///< m, from the rim: the beam's footprint and what the
                  ///< rectangle's place is uncertain by
  double score;   ///< of the evidence, only ranks looks
};

/// A cheap look at a piece, at some hundred rays: what lies inside the
/// rectangle (board) and beyond its rim (anything but more of the same plane).
/// None when it cannot be the board: most pieces end here.
std::optional<FirstLook> look_at_region(const PatchContext& context, const PlanarRegion& region);

/// All of it: the plane and its noise from all returns, the rim from all rays.
/// None when it cannot be the board.
std::optional<BoardCandidate> judge_look(const PatchContext& context, const FirstLook& look);

}  // namespace ca2
