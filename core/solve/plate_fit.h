/// @file Where a plate of known size lies in a scan, from one patch's plane and its rim.
#pragma once

#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// A way for the plate to lie in a patch. Turned by half a turn about its centre it lies as well.
struct PlateFit {
  Pose T_lidar_plate;   ///< of the plate's centre, x and y along its width and height, z away from the sensor
  Matrix6d covariance;  ///< right perturbation (rotation, translation): of what plane and rim leave open
};

/// The ways in which the plate of `outline` explains the patch's rim: none where too little of a rim was
/// seen, or where that is another thing's; two where the plate is about a square, a quarter turn apart. The
/// print's place on the plate plays no part. `normal_sigma`: of the patch's plane, rad.
std::vector<PlateFit> fit_plate(const LidarSight& sight, const Outline& outline, double normal_sigma);

}  // namespace ca2
