/// @file A camera's intrinsics from views of a board.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/types/result.h"

namespace ca2 {

/// What may still be called an answer.
struct IntrinsicsGates {
  int min_views = 5;                  ///< views that agree with each other
  double min_coverage = 0.25;         ///< share of the picture (6 x 6 cells) that has seen a corner
  double min_tilt = 0.15;             ///< rad, largest angle between two boards' normals
  double max_focal_sigma = 0.01;      ///< relative, of the focal length on the axis
  double max_center_sigma = 0.02;     ///< of the principal point, relative to the picture's width
  double max_projection_sigma = 1.0;  ///< px, IntrinsicsEstimate::projection_sigma
};

/// One view of the input, in its order.
struct IntrinsicsView {
  bool used = false;
  std::string reason;                  ///< why not used; empty when it was
  std::optional<Pose> T_camera_board;  ///< also of unused views, where there is one
  double reprojection_rms = 0;         ///< px, of the corners that were used
  int corners_used = 0;
  int corners_rejected = 0;  ///< too far off where the rest of the view fits
};

struct IntrinsicsEstimate {
  Camera camera;
  /// Of the parameters, in their order; scaled by the noise the residuals show, whatever the scale of the
  /// corners' covariances.
  Eigen::MatrixXd covariance;
  std::vector<IntrinsicsView> views;
  double reprojection_rms = 0;  ///< px, all corners used
  double noise_scale = 1;  ///< standard deviation of the corners relative to what their covariances claim
  /// How far a known ray's pixel may be off, rms where the corners were, px: the effect of the covariance
  /// less what a rotation of the camera undoes.
  double projection_sigma = 0;
};

/// Estimates the intrinsics of the named model from the corners seen in each view (ids of `board`,
/// covariances right up to one common factor). Needs no first guess; deterministic. Wrong views and corners
/// are left out and say why. ErrorCode::refused with words on what to show next where the views cannot
/// determine the camera; ErrorCode::usage for a model that does not exist or a picture without size.
Result<IntrinsicsEstimate> estimate_intrinsics(const Board& board, int width, int height,
                                               std::string_view model,
                                               std::span<const std::vector<Corner>> views,
                                               const IntrinsicsGates& gates = {});

}  // namespace ca2
