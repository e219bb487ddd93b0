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

/// What puts the board's corners at their pixels.
struct CornerModel {
  const Camera& camera;
  const Pose& T_camera_board;
  Eigen::Vector2d stretch;  ///< of the print along the board's x and y: printed over stated length, less 1
};

/// What is unknown of it beside the pose.
struct CornerUnknowns {
  int parameters = 4;    ///< so many of the camera's, from the first on
  bool stretch = false;  ///< and the print's stretch
};

/// To project a corner with its derivatives costs ten times what it costs to move its residual along them.
/// Once the board pose hardly changes, the derivatives of an earlier place will do: what is neglected is of
/// second order in the move.
class CornerField {
 public:
  /// `positions`: of the board's corners by id as stated, board frame, m.
  CornerField(std::span<const Corner> corners, std::span<const Eigen::Vector2d> positions,
              const CornerUnknowns& unknowns);

  bool empty() const { return corners_.empty(); }
  std::size_t size() const { return corners_.size(); }

  /// Projects anew where the pose or the intrinsics are further than `reach` from where that was last done,
  /// or where corners changed sides between quadratic and linear cost. False where a corner does not project.
  /// `scale`: true over stated standard deviation of the corners; `huber`: whitened error from which the cost
  /// grows linearly; `reach`: rad, and share of the board's distance.
  bool approach(const CornerModel& model, double scale, double huber, double reach);

  /// At the place last approached, or close to it.
  CameraEquations equations(const CornerModel& model, double scale, double huber) const;
  /// The very cost of `equations` close to the place last approached, the projections' own elsewhere:
  /// infinite where a corner does not project.
  double cost(const CornerModel& model, double scale, double huber) const;

  /// Errors at the place last approached or close to it, whitened by the stated covariances: [2 x corners].
  /// Zero before anything was approached.
  Eigen::Matrix2Xd errors(const CornerModel& model) const;
  /// The same less what another pose of the board would take away.
  Eigen::Matrix2Xd errors_about_own_pose(const CornerModel& model) const;
  /// Reprojection error, px rms.
  double rms(const CornerModel& model) const;
  /// How far a unit of each of the camera's unknown parameters moves a corner at most, px, at the place last
  /// approached.
  const CameraParameters& moves() const { return moves_; }
  int id(std::size_t corner) const { return corners_[corner].id; }

 private:
  static constexpr double intrinsics_reach = 0.5;  ///< px a corner moves: linear in the parameters so far
  using Vector = CameraEquations::Vector;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  struct Seen {
    int id;
    Eigen::Vector3d p_board;  ///< m
    Eigen::Vector2d pixel;
    Eigen::Matrix2d whitening;  ///< W'W = covariance^-1, lower triangular
  };

  /// Derivatives of a corner's whitened error at the place last approached, transposed.
  auto J(std::size_t corner) const { return J_.middleCols<2>(2 * static_cast<Eigen::Index>(corner)); }
  auto e(std::size_t corner) const { return e_.col(static_cast<Eigen::Index>(corner)); }

  /// From the place last approached.
  Vector way_to(const CornerModel& model) const;
  bool close(const Vector& way, const CornerModel& model) const;
  Eigen::Matrix2Xd errors_after(const Vector& way) const;
  bool project(const CornerModel& model);
  /// Sums up all rows, and notes those whose cost is not quadratic for certain.
  void settle(double limit);

  std::vector<Seen> corners_;
  CornerUnknowns unknowns_;
  Eigen::Index size_;  ///< of the pose and the unknowns
  bool approached_ = false;
  double reach_ = 0;
  Pose T_camera_board_;
  CameraParameters parameters_;  ///< those that are unknown
  Eigen::Vector2d stretch_ = Eigen::Vector2d::Zero();
  CameraParameters moves_;
  Eigen::Matrix2Xd e_;               ///< whitened errors at the place last approached
  Jacobian J_;                       ///< [unknowns x 2 per corner], and zeros up to whole fours
  CameraEquations settled_;          ///< of unscaled errors, as if all their costs were quadratic
  double settled_up_to_ = 0;         ///< the largest whitened error whose cost surely is
  double limit_ = 0;                 ///< errors up to here surely are
  std::vector<std::size_t> single_;  ///< the others
};

}  // namespace ca2
