#include "core/geometry/plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ca2 {

Plane facing_origin(const Plane& plane) {
  return plane.offset < 0 ? Plane{-plane.normal, -plane.offset} : plane;
}

Plane transform(const Pose& T_a_b, const Plane& plane) {
  const Eigen::Vector3d normal = T_a_b.R * plane.normal;
  return facing_origin({normal, plane.offset - normal.dot(T_a_b.t)});
}

Plane board_plane(const Pose& T_sensor_board) {
  return transform(T_sensor_board, Plane{Eigen::Vector3d::UnitZ(), 0});
}

Plane fit_plane(std::span<const Eigen::Vector3d> points, double* rms) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p;
  mean /= static_cast<double>(std::max<std::size_t>(points.size(), 1));
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
  const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
  if (rms) {
    *rms = std::sqrt(std::max(0.0, eigen.eigenvalues()(0)) /
                     static_cast<double>(std::max<std::size_t>(points.size(), 1)));
  }
  return facing_origin({normal, -normal.dot(mean)});
}

}  // namespace ca2
