/// @file From what the sensors saw to the calibration of the rig, by any of the methods.
#pragma once

#include <cstdint>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "core/features/sights.h"
#include "core/session/calibration.h"
#include "core/session/rig.h"
#include "core/solve/joint_solver.h"
#include "core/types/result.h"

namespace ca2 {

enum class Method { joint, plane_to_plane, kim };

struct CalibrateOptions {
  Method method = Method::joint;
  std::uint64_t seed = 1;
  /// What is assumed of given intrinsics and of range biases (joint only): standard deviations; 0 holds them.
  double prior_focal = 0.003;  ///< of fx and fy, relative
  double prior_center = 1.0;   ///< of cx and cy, px
  double prior_bias = 0.012;   ///< of a LiDAR's range bias, m
  /// The same of what is held until the corners contradict it.
  double prior_distortion = 3;   ///< of a given lens's distortion, px a coefficient moves corners at most
  double prior_stretch = 0.003;  ///< of the print along x and y, relative
  double prior_size = 0.03;      ///< the same where LiDARs contradict it: a print scaled to fit a page
  /// Cameras whose intrinsics were estimated from the same views: standard deviation of each parameter.
  std::map<std::string, Eigen::VectorXd> estimated;
  /// Once this is asked for, the calibration fails within milliseconds with ErrorCode::unavailable.
  std::stop_token stop = {};
};

/// The rig's cameras must all have intrinsics here (estimated ones count; `estimated` says which, by index in
/// the rig's order, with their standard deviations). The views' sensors are indexed in the rig's order (by
/// name). Refusals (ErrorCode::refused) say what the views cannot determine and which pose of the board would
/// cure it.
Result<Calibration> calibrate(const Rig& rig, const std::vector<ViewSights>& views,
                              const CalibrateOptions& options);

}  // namespace ca2
