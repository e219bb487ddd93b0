/// @file From half a pixel to the limit that the picture's noise sets.
#pragma once

#include <span>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

/// The corners fitted to the pixels (saddle_fit.h), each in a patch that reaches nearly half-way to its
/// neighbours and leaves out what the board prints beside the corner (markers). Covariances follow from the
/// fit's information and the residuals of all patches, with a floor for what the model cannot know. Corners
/// whose patch does not look like one (covered, at the picture's rim, without neighbours) are left out.
std::vector<Corner> refine_corners(const Board& board, const GreyView& image,
                                   std::span<const Corner> corners);

}  // namespace ca2
