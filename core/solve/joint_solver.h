/// @file The joint maximum-likelihood calibration of a rig: chooses the returns, estimates the noise, solves,
/// gates.
#pragma once

#include <Eigen/Core>
#include <stop_token>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/features/sights.h"
#include "core/solve/corner_doubts.h"
#include "core/solve/edge_noise.h"
#include "core/solve/joint_problem.h"
#include "core/solve/rig_seed.h"

namespace ca2 {

struct JointOptions {
  double prior_bias = 0;  ///< sigma of the LiDARs' range biases, m; 0 holds them at 0
  std::vector<CameraParameters> prior_intrinsics;  ///< by camera: sigma of fx, fy, cx, cy, px; 0 holds one
  std::vector<bool> stated;  ///< by camera: the intrinsics are not from these views; how far off they may be
                             ///< is weighed by what the views show
  DoubtPriors doubt_priors;  ///< of what is believed until the views contradict it
  std::vector<RelativePrior> relative;
  std::vector<double> lens_radius;  ///< by LiDAR, m, see `lens_gain`; 0 or empty: nothing to ask
  std::stop_token stop = {};        ///< once this is asked for it gives up soon, and the answer means nothing
};

/// What became of a view.
struct JointViewOutcome {
  bool used = false;
  std::string reason;           ///< why not; empty when used
  Misfit misfit;                ///< of the sensors, at the answer
  double reprojection_rms = 0;  ///< px
  double plane_rms = 0;         ///< m
};

struct JointAnswer {
  JointState state;            ///< T_ref_board of unused views is not meaningful
  Eigen::MatrixXd covariance;  ///< of the globals, in JointProblem's order, inflated by `variance_factor`
  std::vector<JointViewOutcome> views;
  std::vector<std::vector<int>> chosen;  ///< [view][lidar]: the hypothesis that is the board, -1: none
  std::vector<double> range_sigma;       ///< by LiDAR, m
  std::vector<int> free_intrinsics;      ///< by camera: how many of its parameters were unknowns
  bool stretch_free = false;             ///< the print's stretch was unknown too
  bool rims_off = false;                 ///< rims lie behind the print or outside of the plates, beyond doubt
  std::vector<double> corner_scale;      ///< by camera: measured over predicted corner noise
  std::vector<double>
      view_sigma;  ///< by LiDAR, m: what all returns of a view err by together; 0: nothing seen
  std::vector<EdgeNoise> edge_noise;  ///< by LiDAR
  /// By LiDAR: how much more probable the rims are where its beams begin in the lens of
  /// JointOptions::lens_radius, logarithm; empty without rims.
  std::vector<double> lens_gain;
  std::vector<double> outline_offset;  ///< by LiDAR, m: rms distance, in the plane, from the plates' centres
                                       ///< as their rims show them to where the answer without rims has them:
                                       ///< an independent check; NaN: none
  /// By view: the misfit that planes and noise leave, before rims and before errors were found to explain it;
  /// all 0 where the view is not used.
  std::vector<Misfit> plane_misfits;
  int edges = 0;                  ///< sides of plates in the answer
  bool by_rims = false;           ///< planes alone would not determine it: RigSeed::by_rims
  bool edges_dropped = false;     ///< the rims contradict the rest and are not in the answer
  double camera_factor = 1;       ///< >= 1, on the variance of the corners: how much the cameras disagree
                                  ///< with each other beyond their noise; it is in `corner_scale`
  double variance_factor = 1;     ///< >= 1: how much cameras and LiDARs disagree beyond it
  Eigen::MatrixXd leave_one_out;  ///< [used view x globals]: how the answer moves when the view is left out;
                                  ///< empty when any such set would not determine it
};

/// Solves from `seed`. `views` are those the seed was made from; `lidars` the number of LiDARs. Never fails:
/// what is not determined shows in the covariance (possibly infinite), and views without use in `views`.
JointAnswer solve_joint(const Board& board, const std::vector<Camera>& cameras, int lidars,
                        const std::vector<ViewSights>& views, const RigSeed& seed,
                        const JointOptions& options);

/// JointAnswer::plane_misfits alone, of all views that can be used: none is dropped for disagreeing. Empty
/// where planes would not determine the answer.
std::vector<Misfit> plane_misfits(const Board& board, const std::vector<Camera>& cameras, int lidars,
                                  const std::vector<ViewSights>& views, const RigSeed& seed,
                                  const JointOptions& options);

}  // namespace ca2
