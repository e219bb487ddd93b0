/// @file What a view of the board tells of where a LiDAR sits relative to a camera, before it is taken.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// Rotation, translation (right perturbation of T_camera_lidar), range bias of the LiDAR.
using PairInformation = Eigen::Matrix<double, 7, 7>;

/// A camera, a LiDAR and their noise.
struct SightModel {
  Board board;
  Camera camera;
  Pose T_camera_lidar;
  double corner_sigma = 0.05;        ///< px
  double range_sigma = 0.01;         ///< m, of one return
  double returns_per_steradian = 0;  ///< of a whole hold, where the board is held
  double lowest = -M_PI / 2;         ///< rad: elevation of the LiDAR's rings above its x-y plane
  double highest = M_PI / 2;         ///< rad
};

/// The information of corners and ranges together, the board's pose in the view being unknown (Schur
/// complement). Zero where the camera does not see all of the board.
PairInformation view_information(const SightModel& model, const Pose& T_camera_board);

/// How good an answer of this information is: the mean of squared sigma over its target, of translation and
/// of rotation, or infinity where something is not determined. What views are chosen to lower.
struct SigmaTarget {
  double translation = 2e-3;  ///< m
  double rotation = 1e-3;     ///< rad
};
struct ExpectedSigma {
  double translation = 0;  ///< m, root of the trace
  double rotation = 0;     ///< rad
  double cost = 0;         ///< (translation / target)^2 + (rotation / target)^2
};
ExpectedSigma expected_sigma(const PairInformation& information, const SigmaTarget& target);

/// What is known of a range bias of a LiDAR before any view: the least that makes sigmas finite.
PairInformation bias_prior(double sigma);

}  // namespace ca2
