#include "core/solve/lidar_terms.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// Places of the LiDAR's own numbers in SensorEquations.
constexpr Eigen::Index bias_at = 6, dilation_at = 7, margin_at = 8, slope_at = 9, depth_at = 10;

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
  Vector11d& g = equations->g;
  Matrix11d& H = equations->H;
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

double add_edges(std::span<const EdgeSums> edges, double sway, const Pose& T_lidar_board,
                 const LidarErrors& errors, SensorEquations* equations) {
  if (edges.empty()) return 0;
  const Eigen::Vector3d depth(0, 0, errors.rim_depth);
  double cost = 0;
  Vector9d g = Vector9d::Zero();
  Matrix9d H = Matrix9d::Zero();
  for (const EdgeSums& edge : edges) {
    const Eigen::Vector3d own_a = edge.a + depth, own_b = edge.b + depth;
    const Eigen::Vector3d a = T_lidar_board * own_a;
    const Eigen::Vector3d b = T_lidar_board * own_b;
    const Eigen::Vector3d across = a.cross(b);
    const double length = across.norm();
    const Eigen::Vector3d normal = across / length;
    Eigen::Vector4d z;
    z << normal, errors.dilation.at(edge.range);
    const Eigen::Vector4d Hz = edge.H.lazyProduct(z);
    cost += 0.5 * z.dot(Hz);
    if (!equations && !(sway > 0)) continue;
    Eigen::Matrix<double, 3, 6> by_a, by_b;  // of the ends
    by_a << -T_lidar_board.R * skew(own_a), T_lidar_board.R;
    by_b << -T_lidar_board.R * skew(own_b), T_lidar_board.R;
    const Eigen::Matrix3d flat = (Eigen::Matrix3d::Identity() - normal * normal.transpose()) / length;
    Eigen::Matrix<double, 4, 9> J = Eigen::Matrix<double, 4, 9>::Zero();
    J.topLeftCorner<3, 6>() = (flat * skew(a)).lazyProduct(by_b) - (flat * skew(b)).lazyProduct(by_a);
    J(3, 6) = 1;
    J(3, 7) = 1 / edge.range;
    J.col(8) = J.col(5);  // the rim's depth moves its ends as the pose does along its z axis
    const Eigen::Matrix<double, 4, 9> HJ = edge.H.lazyProduct(J);
    H += J.transpose().lazyProduct(HJ);
    g += J.transpose().lazyProduct(Hz);
  }
  if (sway > 0) {
    // The plate is off its pose along its axes, which is what moving the pose along them does.
    const Eigen::Matrix2d inverse =
        (H.block<2, 2>(3, 3) + 1 / (sway * sway) * Eigen::Matrix2d::Identity()).inverse();
    const Eigen::Matrix<double, 9, 2> columns = H.middleCols<2>(3);
    const Eigen::Vector2d slope = g.segment<2>(3);
    cost -= 0.5 * slope.dot(inverse * slope);
    H -= columns * inverse * columns.transpose();
    g -= columns * (inverse * slope);
  }
  if (!equations) return cost;
  constexpr std::array<Eigen::Index, 9> places{0, 1, 2, 3, 4, 5, dilation_at, margin_at, depth_at};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto from = static_cast<Eigen::Index>(i);
    equations->g(places[i]) += g(from);
    for (std::size_t k = 0; k < places.size(); ++k)
      equations->H(places[i], places[k]) += H(from, static_cast<Eigen::Index>(k));
  }
  return cost;
}

}  // namespace ca2
