/// @file The maximum-likelihood problem of a whole rig: corners, ranges along the rays, and priors.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/solve/edge_sums.h"
#include "core/solve/misfit.h"
#include "core/solve/range_sums.h"

namespace ca2 {

/// What a view contributes, by sensor index. Sensors that did not see the board contribute nothing.
struct JointView {
  std::vector<std::vector<Corner>> corners;  ///< by camera; covariance in px^2, already scaled to the truth
  std::vector<std::optional<RangeSums>> ranges;  ///< by LiDAR
  std::vector<std::vector<EdgeSums>> edges;      ///< by LiDAR: of the plate's sides
};

/// A known relative pose of two sensors (a factory stereo pair), with its information.
struct RelativePrior {
  int a = 0;  ///< sensor index: cameras first, then LiDARs
  int b = 0;
  Pose T_a_b;
  Matrix6d information;  ///< right perturbation of T_a_b
};

/// Everything that is held while solving.
struct JointInput {
  std::vector<Eigen::Vector2d> board_corners;  ///< by id, board frame, m
  std::vector<Camera> cameras;                 ///< intrinsics as given: the priors' means
  std::vector<JointView> views;
  std::vector<RelativePrior> relative;
  std::vector<double> range_sigma;                ///< by LiDAR, m
  std::vector<Eigen::Vector4d> prior_intrinsics;  ///< by camera: sigma of fx, fy, cx, cy, px; 0 holds one
  double prior_bias = 0;                          ///< sigma of a LiDAR's range bias, m; 0 holds it at 0
  std::vector<double> prior_range_slope;  ///< by LiDAR: sigma of the slope of its range errors, m; 0 holds it
  double prior_dilation =
      0;  ///< sigma of the angle by which a LiDAR sees plates too large, rad; 0 holds it at 0
  double corner_huber = 3;  ///< whitened corner error from which the cost grows linearly
};

/// The unknowns. The first camera is the reference frame.
struct JointState {
  std::vector<Pose> T_ref_camera;
  std::vector<Pose> T_ref_lidar;
  std::vector<Camera> cameras;      ///< current intrinsics
  std::vector<double> range_bias;   ///< by LiDAR, m
  std::vector<double> range_slope;  ///< by LiDAR, m per sine of the elevation, see RangeSums
  std::vector<double> dilation;     ///< by LiDAR, rad, see EdgeSums
  std::vector<Pose> T_ref_board;    ///< by view
};

/// Costs and normal equations for `minimize`. The board poses are eliminated view by view (Schur complement),
/// so that a step costs time linear in the views.
///
/// Order of the global unknowns: 6 per camera but the first, 6 per LiDAR, 4 per camera (fx, fy, cx, cy), 1
/// per LiDAR (range bias), 1 per LiDAR (dilation), 1 per LiDAR (range slope); poses as right perturbations
/// (rotation, translation) of T_ref_sensor.
class JointProblem {
 public:
  using State = JointState;
  explicit JointProblem(const JointInput& input);

  double linearize(const State& state);
  double cost(const State& state) const;
  std::optional<Eigen::VectorXd> step(double damping) const;
  double predicted_decrease(const Eigen::VectorXd& step) const;
  State moved(const State& state, const Eigen::VectorXd& step) const;

  /// How far a view's sensors disagree about the board at the solution.
  Misfit misfit(const State& state, std::size_t view) const;

  int globals() const { return globals_; }
  int camera_pose_index(int camera) const { return 6 * (camera - 1); }  ///< camera > 0
  int lidar_pose_index(int lidar) const { return lidar_poses_ + 6 * lidar; }
  int intrinsics_index(int camera) const { return intrinsics_ + 4 * camera; }
  int bias_index(int lidar) const { return biases_ + lidar; }
  int dilation_index(int lidar) const { return biases_ + lidars_ + lidar; }
  int slope_index(int lidar) const { return biases_ + 2 * lidars_ + lidar; }

  /// Information of the globals with the board poses marginalised, at the state last linearised.
  Eigen::MatrixXd information() const;
  /// One view's share of `information()` and of the marginal gradient: what leaving it out takes away.
  void view_share(std::size_t view, Eigen::MatrixXd& information, Eigen::VectorXd& gradient) const;

 private:
  struct ViewEquations {
    Matrix6d Hvv;
    Eigen::Matrix<double, 6, Eigen::Dynamic> Hvg;
    Eigen::MatrixXd Hgg;
    Eigen::VectorXd gg;
    Vector6d gv;
  };
  void clear(ViewEquations& equations) const;
  double add_view(const State& state, std::size_t view, ViewEquations* equations) const;
  double add_corners(const State& state, std::size_t view, int camera, ViewEquations* equations) const;
  double add_ranges(const State& state, std::size_t view, int lidar, ViewEquations* equations) const;
  double add_edges(const State& state, std::size_t view, int lidar, ViewEquations* equations) const;
  double add_priors(const State& state, Eigen::MatrixXd* H, Eigen::VectorXd* g) const;
  const Pose& sensor_pose(const State& state, int sensor) const;
  int sensor_index(int sensor) const;  ///< of its pose among the globals; -1: the reference

  const JointInput& input_;
  int cameras_, lidars_, lidar_poses_, intrinsics_, biases_, globals_;
  std::vector<std::vector<std::vector<Eigen::Matrix2d>>>
      whitening_;  ///< [view][camera][corner]: W'W = covariance^-1
  std::vector<ViewEquations> views_;
  Eigen::MatrixXd prior_H_;
  Eigen::VectorXd prior_g_;
};

}  // namespace ca2
