/// @file The maximum-likelihood problem of a whole rig: corners, ranges along the rays, and priors.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/levenberg_marquardt.h"
#include "core/geometry/pose.h"
#include "core/solve/corner_field.h"
#include "core/solve/edge_sums.h"
#include "core/solve/misfit.h"
#include "core/solve/nuisance_prior.h"
#include "core/solve/range_sums.h"
#include "core/solve/view_elimination.h"

namespace ca2 {

/// What a view contributes, by sensor index. Sensors that did not see the board contribute nothing.
struct JointView {
  std::vector<std::vector<Corner>> corners;      ///< by camera; covariance in px^2, as stated
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
  std::vector<double> range_sigma;  ///< by LiDAR, m
  /// By camera: sigma of its free parameters, which are the first so many of its model's (fx, fy, cx, cy at
  /// least), in their units; 0 holds one.
  std::vector<CameraParameters> prior_intrinsics;
  std::vector<bool> stated;               ///< by camera: the intrinsics are not from these views
  double prior_stretch = 0;               ///< sigma of the print's stretch along x and y; 0: it is as stated
  double prior_bias = 0;                  ///< sigma of a LiDAR's range bias, m; 0 holds it at 0
  std::vector<double> prior_range_slope;  ///< by LiDAR: sigma of the slope of its range errors, m; 0 holds it
  double prior_dilation = 0;  ///< sigma of the angle by which a LiDAR sees plates too large, rad; 0 holds it
  RimFreedom rim_freedom;     ///< all held where rims take no part
  std::vector<double> edge_sway;     ///< by LiDAR: EdgeNoise::sway, m
  std::vector<double> corner_scale;  ///< by camera: true over stated standard deviation of the corners
  /// Takes the place of the priors on intrinsics, stretch, range biases and rims' freedom that are not held:
  /// of the globals from the first camera's intrinsics on, as deviations from what was given.
  std::optional<NuisancePrior> nuisances;
  double corner_reach = 3e-6;  ///< corners are projected anew where a board moved further, see CornerField
  double corner_huber = 3;     ///< whitened corner error from which the cost grows linearly
};

/// The unknowns. The first camera is the reference frame.
struct JointState {
  std::vector<Pose> T_ref_camera;
  std::vector<Pose> T_ref_lidar;
  std::vector<Camera> cameras;                        ///< current intrinsics
  Eigen::Vector2d stretch = Eigen::Vector2d::Zero();  ///< of the print, see CornerModel
  std::vector<double> range_bias;                     ///< by LiDAR, m
  std::vector<double> range_slope;  ///< by LiDAR, m per sine of the elevation, see RangeSums
  std::vector<Dilation> dilation;   ///< by LiDAR
  double rim_depth = 0;             ///< m: where the plates' rims are along the boards' z axes: behind the
                                    ///< print by half the plate's thickness
  std::vector<Pose> T_ref_board;    ///< by view
};

/// Of some views only, as JointProblem indexes them; and back into the state of all.
JointState state_of_views(const JointState& all, std::span<const std::size_t> views);
void take_state_of_views(JointState& all, JointState some, std::span<const std::size_t> views);

/// The priors on intrinsics, stretch, range biases and rims' freedom: as the input has them, or weighed by
/// what the views show, `believed` more readily where these are many and agree in everything.
enum class Priors { as_given, doubted, believed };

/// Costs and normal equations for `minimize`. The board poses are eliminated view by view (Schur complement),
/// so that a step costs time linear in the views; corners are projected anew only where the board moved. The
/// input is read at every call, so that noise, returns and rims may be put right between two solves; the
/// corners are those it had at the construction.
///
/// Order of the global unknowns: 6 per camera but the first, 6 per LiDAR, every camera's free parameters, the
/// print's stretch (2, where unknown), 1 per LiDAR (range bias), 2 per LiDAR (dilation: angle,
/// margin), 1 per LiDAR (range slope), the rims' depth; poses as right perturbations (rotation, translation)
/// of T_ref_sensor.
class JointProblem {
 public:
  using State = JointState;
  explicit JointProblem(const JointInput& input);

  double linearize(const State& state);
  /// The same at the state last linearised, where only the priors are others since.
  double renew_priors(const State& state);
  double cost(const State& state) const;
  std::optional<Eigen::VectorXd> step(double damping);
  double predicted_decrease(const Eigen::VectorXd& step) const;
  State moved(const State& state, const Eigen::VectorXd& step) const;

  /// How far a view's sensors disagree about the board at the solution.
  Misfit misfit(const State& state, std::size_t view);
  /// What camera `camera` saw in a view.
  const CornerField& corners(std::size_t view, int camera) const {
    return corners_[view][static_cast<std::size_t>(camera)];
  }

  /// Standard deviation of the LiDARs' places at the state last linearised, m, the largest; infinite where
  /// they are not determined.
  double lidar_place_sigma() const;
  /// Of a view's ranges off the board, over all LiDARs, m; 0 without any.
  double range_rms(const State& state, std::size_t view) const;

  int globals() const { return globals_; }
  int camera_pose_index(int camera) const { return 6 * (camera - 1); }  ///< camera > 0
  int lidar_pose_index(int lidar) const { return lidar_poses_ + 6 * lidar; }
  int intrinsics_index(int camera) const { return intrinsics_[static_cast<std::size_t>(camera)]; }
  /// How many of a camera's parameters are unknowns.
  int free_intrinsics(int camera) const { return intrinsics_index(camera + 1) - intrinsics_index(camera); }
  bool distortion_free() const;  ///< of any camera
  bool stretch_free() const { return biases_ > stretch_; }
  int stretch_index() const { return stretch_; }
  int bias_index(int lidar) const { return biases_ + lidar; }
  int dilation_index(int lidar) const { return biases_ + lidars_ + 2 * lidar; }  ///< angle; margin
  int margin_index(int lidar) const { return dilation_index(lidar) + 1; }
  int slope_index(int lidar) const { return biases_ + 3 * lidars_ + lidar; }
  int rim_depth_index() const { return biases_ + 4 * lidars_; }

  /// Information of the globals with the board poses marginalised, at the state last linearised.
  Eigen::MatrixXd information() const;
  /// What the views at the state last linearised, close to the minimum, say of the deviations that have a
  /// prior: stated focal lengths, principal points and distortion, the print's stretch, the range biases and
  /// the rims' freedom are a group each. Nothing where they are all held or the views determine nothing
  /// without them. `priors`: not as given.
  std::optional<NuisanceEvidence> nuisance_evidence(const State& state, Priors priors) const;

  /// One view's share of `information()` and of the marginal gradient, at the state last linearised: what
  /// leaving it out takes away.
  void view_share(const State& state, std::size_t view, Eigen::MatrixXd& information,
                  Eigen::VectorXd& gradient);

 private:
  /// What is left of the equations without the board poses, priors included, at the state last linearised.
  DenseNormalEquations marginal() const;
  Pose sensor_board(const State& state, int sensor, std::size_t view) const;
  /// Cost of one LiDAR in one view, with its derivatives where asked for.
  double lidar_cost(const State& state, std::size_t view, int lidar, SensorEquations* equations) const;
  /// Puts the view's equations into `views_`, and adds what it has by the globals alone to `into`.
  double linearize_view(const State& state, std::size_t view, DenseNormalEquations& into);
  /// `sensor`: SensorEquations or CameraEquations; `numbers`: places of the sensor's own among the globals.
  template <typename Equations>
  static void add_sensor(const Equations& sensor, const Pose& T_sensor_board, int pose,
                         std::span<const int> numbers, ViewEquations& equations, DenseNormalEquations& into);
  double corner_scale(int camera) const;
  double add_priors(const State& state, DenseNormalEquations* equations) const;
  Eigen::VectorXd deviations(const State& state) const;  ///< in the order of JointInput::nuisances
  const Pose& sensor_pose(const State& state, int sensor) const;
  int sensor_index(int sensor) const;  ///< of its pose among the globals; -1: the reference

  const JointInput& input_;
  int cameras_, lidars_, lidar_poses_;
  std::vector<int> intrinsics_;  ///< by camera: index of the first; and where the last one's end
  int stretch_, biases_, globals_;
  std::vector<std::vector<CornerField>> corners_;  ///< [view][camera]
  std::vector<ViewEquations> views_;
  std::vector<Elimination> eliminated_;
  DenseNormalEquations prior_;
  DenseNormalEquations total_;  ///< of all views
  double views_cost_ = 0;       ///< of all views
};

/// Minimises; where they are not to be `as_given`, weighs the priors by what the views show
/// (input.nuisances; from three views on) and minimises with these. `input` is the problem's; the problem is
/// left linearised at `state`: three or four views leave too little over to be sure that given values are
/// right, so that its information is then the one with the priors as given, but for those on rims.
void minimize_and_weigh(JointProblem& problem, JointInput& input, JointState& state, Priors priors);

}  // namespace ca2
