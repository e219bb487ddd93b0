/// @file The least squares behind estimate_intrinsics: one camera, one board pose per view.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"

namespace ca2 {

struct BundleCorner {
  Eigen::Vector3d p_board;   ///< m
  Eigen::Vector2d pixel;     ///< px
  Eigen::Matrix2d whitener;  ///< inverse Cholesky factor of the pixel's covariance, 1/px
  bool active = true;
};

struct BundleView {
  std::vector<BundleCorner> corners;
  bool used = true;
};

/// Whitened reprojection error of a corner; nothing where it does not project.
std::optional<Eigen::Vector2d> whitened_residual(const Camera& camera, const Pose& T_camera_board,
                                                 const BundleCorner& corner);

/// A Problem of levenberg_marquardt.h: Huber's cost on the whitened length of each corner's error. The poses
/// are eliminated by Schur complement, so that an iteration is linear in the number of views.
class IntrinsicsBundle {
 public:
  struct State {
    Camera camera;
    std::vector<Pose> poses;  ///< T_camera_board by view
  };

  /// `huber`: whitened length beyond which the cost grows linearly.
  IntrinsicsBundle(const std::vector<BundleView>& views, double huber) : views_(views), huber_(huber) {}

  double linearize(const State& state);
  std::optional<Eigen::VectorXd> step(double damping) const;
  double predicted_decrease(const Eigen::VectorXd& step) const;
  State moved(const State& state, const Eigen::VectorXd& step) const;
  double cost(const State& state) const;

  /// Information of the camera's parameters with the poses unknown, at the last linearisation.
  std::optional<Eigen::MatrixXd> information() const;

 private:
  struct Block {
    Matrix6d H;
    Vector6d g;
    Eigen::Matrix<double, Eigen::Dynamic, 6, 0, max_camera_parameters, 6> coupling;
  };

  /// The system of the camera's parameters after eliminating the damped poses.
  bool reduce(double damping, Eigen::MatrixXd& H, Eigen::VectorXd& g) const;

  const std::vector<BundleView>& views_;
  double huber_;
  Eigen::MatrixXd H_;  ///< of the camera's parameters
  Eigen::VectorXd g_;
  std::vector<Block> blocks_;  ///< by view
};

}  // namespace ca2
