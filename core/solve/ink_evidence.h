/// @file Does what a LiDAR got back from a plate show the print where it is held to be?
#pragma once

#include "core/board/board.h"
#include "core/board/ink_map.h"
#include "core/features/sights.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// How much more probable the intensities of the returns on the plate are with the print at T_lidar_board
/// than if they told nothing of it, as a logarithm; 0 where they are darker on white, or not known. Two ways
/// of placing the same plate are compared by the difference.
///
/// Two means, of black and of white, with a common variance: n / 2 log(sum of squares without over with), the
/// gain of every ring and what changes evenly along the plate taken out of both. Neighbouring returns err
/// together, so n is the number of independent ones, by the residuals' own correlation along the rings.
double ink_log_odds(const LidarSight& sight, const InkMap& ink, const Outline& outline,
                    const Pose& T_lidar_board);

}  // namespace ca2
