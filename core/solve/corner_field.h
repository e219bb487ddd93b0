/// @file The corners one camera saw in one view, held as a linear model that is renewed only where the board
/// moved.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/solve/sensor_equations.h"

namespace ca2 {

/// To project a corner with its derivatives costs ten times what it costs to move its residual along them.
/// Once the board pose hardly changes, the derivatives of an earlier place will do: what is neglected is of
/// second order in the move.
class CornerField {
 public:
  /// `positions`: of the board's corners by id, board frame, m.
  CornerField(std::span<const Corner> corners, std::span<const Eigen::Vector2d> positions);

  bool empty() const { return rows_.empty(); }
  std::size_t size() const { return rows_.size(); }

  /// Projects anew where the pose or the intrinsics are further than `reach` from where that was last done,
  /// or where corners changed sides between quadratic and linear cost. False where a corner does not project.
  /// `scale`: true over stated standard deviation of the corners; `huber`: whitened error from which the cost
  /// grows linearly; `reach`: rad, and share of the board's distance.
  bool approach(const Camera& camera, const Pose& T_camera_board, double scale, double huber, double reach);

  /// At the place last approached, or close to it.
  SensorEquations equations(const Camera& camera, const Pose& T_camera_board, double scale,
                            double huber) const;
  /// The very cost of `equations` close to the place last approached, the projections' own elsewhere:
  /// infinite where a corner does not project.
  double cost(const Camera& camera, const Pose& T_camera_board, double scale, double huber) const;

  /// Errors at the place last approached or close to it, whitened by the stated covariances: [2 x corners].
  /// Zero before anything was approached.
  Eigen::Matrix2Xd errors(const Camera& camera, const Pose& T_camera_board) const;
  /// The same less what another pose of the board would take away.
  Eigen::Matrix2Xd errors_about_own_pose(const Camera& camera, const Pose& T_camera_board) const;
  /// Reprojection error, px rms.
  double rms(const Camera& camera, const Pose& T_camera_board) const;
  int id(std::size_t corner) const { return corners_[corner].id; }

 private:
  static constexpr double intrinsics_reach = 0.1;  ///< px: the projection is linear in these

  struct Seen {
    int id;
    Eigen::Vector3d p_board;  ///< m
    Eigen::Vector2d pixel;
    Eigen::Matrix2d whitening;  ///< W'W = covariance^-1, lower triangular
  };
  /// Whitened error and its derivatives at the place last approached.
  struct Row {
    Eigen::Vector2d e;
    Eigen::Matrix<double, 10, 2> J;  ///< transposed
  };

  /// From the place last approached.
  Vector10d way_to(const Camera& camera, const Pose& T_camera_board) const;
  bool close(const Vector10d& way, const Pose& T_camera_board) const;
  bool project(const Camera& camera, const Pose& T_camera_board);
  /// Sums up the rows whose cost is quadratic for certain; the others stay single.
  void settle(double limit);
  double single_cost(const Vector10d& way, double scale, double huber) const;

  std::vector<Seen> corners_;
  bool approached_ = false;
  double reach_ = 0;
  Pose T_camera_board_;
  Eigen::Vector4d intrinsics_;
  std::vector<Row> rows_;
  SensorEquations settled_;   ///< of unscaled errors
  double settled_up_to_ = 0;  ///< the largest whitened error among them
  double limit_ = 0;          ///< errors up to here were settled
  std::vector<std::size_t> single_;
};

}  // namespace ca2
