/// @file Can these views determine the answer, and if not, what is missing - in words for the person with the
/// board.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/session/calibration.h"
#include "core/types/result.h"

namespace ca2 {

/// What the verdict on one camera-LiDAR pair is based on.
struct PairEvidence {
  std::string camera, lidar;
  Pose T_camera_lidar;
  Matrix6d covariance;                   ///< of it, right perturbation
  std::vector<Eigen::Vector3d> normals;  ///< of the boards in use, camera frame
  double normal_sigma = 0;               ///< rad, typical noise of one normal
  int candidates = 0;                    ///< views in which both sensors had something to offer
  bool rims = false;                     ///< the plates' rims took part: one view may determine the answer
};

/// The verdict: an error with ErrorCode::refused that says which direction is weak and how to hold the board
/// to cure it, or "good" / "weak" with the weakest direction in words.
Result<Observability> judge(const PairEvidence& evidence);

}  // namespace ca2
