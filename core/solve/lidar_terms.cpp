#include "core/solve/lidar_terms.h"

#include <cmath>
#include <limits>

namespace ca2 {
namespace {

/// Places of the LiDAR's own numbers in SensorEquations.
constexpr Eigen::Index bias_at = 6, dilation_at = 7, slope_at = 8;

}  // namespace

double add_ranges(const RangeSums& sums, double sigma, const Pose& T_lidar_board, const LidarErrors& errors,
                  SensorEquations* equations) {
  const Eigen::Vector3d m = T_lidar_board.R.col(2);
  const double h = m.dot(T_lidar_board.t);
  if (std::abs(h) < 1e-6) return std::numeric_limits<double>::infinity();
  const double scale = 1 / (sigma * sigma);
  const Vector5d z = sums.z(m / h, errors.range_bias, errors.range_slope);
  const Vector5d Hz = sums.H.lazyProduct(z);
  const double cost = scale * (sums.cost + sums.gradient.dot(z) + 0.5 * z.dot(Hz));
  if (!equations) return cost;
  // q = m / h; dq = dm / h - m dh / h^2 with dm = -R [e3]x dr, dh = e3.dt (turning about the board's own
  // origin moves no point of the axis m through it: dh = dm.t).
  Eigen::Matrix<double, 3, 6> D;
  const Eigen::Matrix3d turn = -T_lidar_board.R * skew(Eigen::Vector3d::UnitZ());
  D.leftCols<3>() = turn / h - m * (T_lidar_board.t.transpose() * turn) / (h * h);
  D.rightCols<3>() = -m * Eigen::RowVector3d::UnitZ() / (h * h);
  const Vector5d gradient = scale * (sums.gradient + Hz);
  const Eigen::Matrix<double, 5, 6> HD = scale * sums.H.leftCols<3>().lazyProduct(D);
  Vector10d& g = equations->g;
  Matrix10d& H = equations->H;
  g.head<6>() += D.transpose().lazyProduct(gradient.head<3>());
  g(bias_at) += gradient(3);
  g(slope_at) += gradient(4);
  H.topLeftCorner<6, 6>() += D.transpose().lazyProduct(HD.topRows<3>());
  for (const auto& [row, at] : {std::pair{3, bias_at}, {4, slope_at}}) {
    H.block<1, 6>(at, 0) += HD.row(row);
    H.block<6, 1>(0, at) += HD.row(row).transpose();
    H(at, bias_at) += scale * sums.H(row, 3);
    H(at, slope_at) += scale * sums.H(row, 4);
  }
  return cost;
}

double add_edges(std::span<const EdgeSums> edges, const Pose& T_lidar_board, const LidarErrors& errors,
                 SensorEquations* equations) {
  double cost = 0;
  for (const EdgeSums& edge : edges) {
    const Eigen::Vector3d a = T_lidar_board * edge.a;
    const Eigen::Vector3d b = T_lidar_board * edge.b;
    const Eigen::Vector3d across = a.cross(b);
    const double length = across.norm();
    const Eigen::Vector3d normal = across / length;
    Eigen::Vector4d z;
    z << normal, errors.dilation;
    const Eigen::Vector4d Hz = edge.H.lazyProduct(z);
    cost += 0.5 * z.dot(Hz);
    if (!equations) continue;
    Eigen::Matrix<double, 3, 6> by_a, by_b;  // of the ends
    by_a << -T_lidar_board.R * skew(edge.a), T_lidar_board.R;
    by_b << -T_lidar_board.R * skew(edge.b), T_lidar_board.R;
    const Eigen::Matrix3d flat = (Eigen::Matrix3d::Identity() - normal * normal.transpose()) / length;
    Eigen::Matrix<double, 4, 7> J = Eigen::Matrix<double, 4, 7>::Zero();
    J.topLeftCorner<3, 6>() = (flat * skew(a)).lazyProduct(by_b) - (flat * skew(b)).lazyProduct(by_a);
    J(3, 6) = 1;
    const Eigen::Matrix<double, 4, 7> HJ = edge.H.lazyProduct(J);
    const Eigen::Matrix<double, 7, 7> H = J.transpose().lazyProduct(HJ);
    const Eigen::Matrix<double, 7, 1> g = J.transpose().lazyProduct(Hz);
    equations->H.topLeftCorner<6, 6>() += H.topLeftCorner<6, 6>();
    equations->H.block<6, 1>(0, dilation_at) += H.block<6, 1>(0, 6);
    equations->H.block<1, 6>(dilation_at, 0) += H.block<1, 6>(6, 0);
    equations->H(dilation_at, dilation_at) += H(6, 6);
    equations->g.head<6>() += g.head<6>();
    equations->g(dilation_at) += g(6);
  }
  return cost;
}

}  // namespace ca2
