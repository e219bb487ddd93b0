#include "core/guidance/view_information.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/scaled_inverse.h"

namespace ca2 {
namespace {

constexpr int grid = 6;  // samples of the board's surface along each side stand for its returns

/// Corner reprojections: information of the board's pose (right perturbation of T_camera_board).
Matrix6d corner_information(const SightModel& model, const Pose& T_camera_board, bool& visible) {
  Matrix6d information = Matrix6d::Zero();
  visible = true;
  for (const Eigen::Vector2d& corner : model.board.type->corners(model.board)) {
    const Eigen::Vector3d p_board(corner.x(), corner.y(), 0);
    ProjectionJacobian jacobian;
    const auto pixel = model.camera.project(T_camera_board * p_board, &jacobian);
    if (!pixel || !model.camera.contains(*pixel, 5)) {
      visible = false;
      return information;
    }
    Eigen::Matrix<double, 3, 6> moved;
    moved << -T_camera_board.R * skew(p_board), T_camera_board.R;
    const Eigen::Matrix<double, 2, 6> J = jacobian.point * moved / model.corner_sigma;
    information += J.transpose() * J;
  }
  return information;
}

}  // namespace

PairInformation view_information(const SightModel& model, const Pose& T_camera_board) {
  bool visible = false;
  Matrix6d Hbb = corner_information(model, T_camera_board, visible);
  const Pose T_lidar_board = model.T_camera_lidar.inverse() * T_camera_board;
  const Eigen::Vector3d normal = T_lidar_board.R.col(2);
  const Outline extent = model.board.extent();
  const double distance = T_lidar_board.t.norm();
  const double facing = std::abs(normal.dot(T_lidar_board.t)) / std::max(distance, 1e-9);
  if (!visible || facing < 0.1) return PairInformation::Zero();

  const double returns =
      model.returns_per_steradian * extent.width * extent.height * facing / (distance * distance);
  const double weight = returns / (grid * grid) / (model.range_sigma * model.range_sigma);
  PairInformation Hxx = PairInformation::Zero();
  Eigen::Matrix<double, 6, 7> Hbx = Eigen::Matrix<double, 6, 7>::Zero();
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      const Eigen::Vector3d p_board(extent.center.x() + ((i + 0.5) / grid - 0.5) * extent.width,
                                    extent.center.y() + ((j + 0.5) / grid - 0.5) * extent.height, 0);
      const Eigen::Vector3d p = T_lidar_board * p_board;
      // Along the ray, the plane is further by n . motion / (n . ray) when this point of it moves.
      const double along = normal.dot(p.normalized());
      const double elevation = std::asin(p.z() / p.norm());
      if (std::abs(along) < 0.1 || elevation < model.lowest || elevation > model.highest) continue;
      // T_lidar_board with T_camera_lidar perturbed by x and T_camera_board by b: exp(-x) T exp(b).
      Eigen::Matrix<double, 1, 7> x;
      x << normal.transpose() / along * skew(p), -normal.transpose() / along, 1;
      Eigen::Matrix<double, 1, 6> b;
      b << normal.transpose() / along * T_lidar_board.R * -skew(p_board),
          normal.transpose() / along * T_lidar_board.R;
      Hxx += weight * x.transpose() * x;
      Hbb += weight * b.transpose() * b;
      Hbx += weight * b.transpose() * x;
    }
  }
  return Hxx - Hbx.transpose() * Hbb.ldlt().solve(Hbx);
}

ExpectedSigma expected_sigma(const PairInformation& information, const SigmaTarget& target) {
  const auto covariance = scaled_inverse(information);
  ExpectedSigma sigma;
  if (!covariance) {
    sigma.translation = sigma.rotation = sigma.cost = std::numeric_limits<double>::infinity();
    return sigma;
  }
  sigma.rotation = std::sqrt(covariance->topLeftCorner<3, 3>().trace());
  sigma.translation = std::sqrt(covariance->block<3, 3>(3, 3).trace());
  sigma.cost =
      std::pow(sigma.translation / target.translation, 2) + std::pow(sigma.rotation / target.rotation, 2);
  return sigma;
}

PairInformation bias_prior(double sigma) {
  PairInformation information = PairInformation::Zero();
  information(6, 6) = 1 / (sigma * sigma);
  return information;
}

}  // namespace ca2
