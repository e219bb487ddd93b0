#include "core/solve/rim_residuals.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

constexpr std::array shares{0.00005, 0.0001, 0.0002, 0.0004, 0.0006,
                            0.0012,  0.0024, 0.0048, 0.0096, 0.02};          // m
constexpr std::array sways{0.0, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016};  // m
/// A side that is off by a shared error seems to be so by a backdrop as well: few views do not tell which of
/// both it is, and being sure of the wrong one is worse. As if both were alike at this range, m; errors up to
/// this one, m, are too small for a backdrop's.
constexpr double usual_range = 1.5, most_without_backdrop = 0.0001;
/// The sides follow the LiDAR's pose and the dilation.
constexpr int fitted_anyway = 8;

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

RimResidual residual(const EdgeSums& edge, const Pose& T_lidar_board, const Dilation& dilation) {
  const Eigen::Vector3d a = T_lidar_board * edge.a, b = T_lidar_board * edge.b;
  const Eigen::Vector3d across = a.cross(b);
  const double length = across.norm();
  const Eigen::Vector3d normal = across / length;
  Eigen::Vector4d z;
  z << normal, dilation.at(edge.range);
  RimResidual side{edge.rows * z, edge.covariance, {}, {}, edge.range, edge.freedom};
  // The side's plane turns with the pose; where both ends move by v, a x b changes by (a - b) x v.
  const Eigen::Matrix3d by_move =
      (Eigen::Matrix3d::Identity() - normal * normal.transpose()) / length * skew(a - b);
  Eigen::Matrix<double, 3, 9> D = Eigen::Matrix<double, 3, 9>::Zero();
  D.leftCols<3>() = -skew(normal);
  D.middleCols<3>(3) = by_move;
  D.col(8) = by_move * T_lidar_board.R.col(2);
  side.by_common = edge.rows.leftCols<3>() * D;
  side.by_common.col(6) += edge.rows.col(3);
  side.by_common.col(7) += edge.rows.col(3) / edge.range;
  side.by_sway = edge.rows.leftCols<3>() * by_move * T_lidar_board.R.leftCols<2>();
  return side;
}

EdgeNoise noise_of(double shared, double sway) {
  return {0, shared, shared > most_without_backdrop ? shared / usual_range : 0, sway};
}

Eigen::Matrix2d covariance_with(const RimResidual& side, double shared) {
  return side.covariance + shared_covariance(noise_of(shared, 0), side.range);
}

/// -2 log likelihood of one view's sides by the sway, with a shared error given.
class ViewDeviance {
 public:
  ViewDeviance(const std::vector<RimResidual>& sides, double shared) {
    for (const RimResidual& side : sides) {
      const Eigen::Matrix2d covariance = covariance_with(side, shared);
      const Eigen::Matrix2d information = covariance.inverse();
      const Eigen::Matrix2d weighted = side.by_sway.transpose() * information;
      misfit_ += side.off.dot(information * side.off);
      log_size_ += std::log(covariance.determinant());
      slope_ += weighted * side.off;
      information_ += weighted * side.by_sway;
    }
  }

  /// The sway eliminated. `scale`: of the misfit, for what the sides were fitted by.
  double at(double sway, double scale) const {
    if (!(sway > 0)) return scale * misfit_ + log_size_;
    const double variance = sway * sway;
    const Eigen::Matrix2d pivot = Eigen::Matrix2d::Identity() + variance * information_;
    return scale * (misfit_ - variance * slope_.dot(pivot.inverse() * slope_)) + log_size_ +
           std::log(pivot.determinant());
  }

 private:
  double misfit_ = 0, log_size_ = 0;
  Eigen::Vector2d slope_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Zero();
};

/// Where the rims are most probable with a shared error; the rims' sway takes no part in it.
Vector9d fit(const RimResiduals& residuals, const RimFreedom& free, double shared) {
  constexpr double held = 1e-9, pose = 1;
  Vector9d prior;
  prior << Vector6d::Constant(pose), dilation_sigma, free.margin > 0 ? free.margin : held,
      free.depth > 0 ? free.depth : held;
  Matrix9d H = prior.cwiseAbs2().cwiseInverse().asDiagonal();
  Vector9d g = Vector9d::Zero();
  for (const std::vector<RimResidual>& sides : residuals) {
    for (const RimResidual& side : sides) {
      const Eigen::Matrix<double, 9, 2> weighted =
          side.by_common.transpose() * covariance_with(side, shared).inverse();
      H += weighted * side.by_common;
      g += weighted * side.off;
    }
  }
  return -H.ldlt().solve(g);
}

}  // namespace

RimResiduals rim_residuals(std::span<const EdgeView> views, const Dilation& dilation, double blur,
                           double slack) {
  RimResiduals residuals;
  for (const EdgeView& view : views) {
    std::vector<RimResidual>& sides = residuals.emplace_back();
    for (const EdgeSums& edge : edge_sums(view, dilation, {blur, 0, 0, 0}, slack))
      sides.push_back(residual(edge, view.T_lidar_board, dilation));
  }
  return residuals;
}

RimErrors likeliest_errors(const RimResiduals& residuals) {
  int freedom = 0;
  for (const std::vector<RimResidual>& sides : residuals) {
    for (const RimResidual& side : sides) freedom += side.freedom;
  }
  if (freedom <= fitted_anyway) return {noise_of(shares[0], 0), 0, freedom};
  const double scale = static_cast<double>(freedom) / (freedom - fitted_anyway);
  RimErrors best{{}, std::numeric_limits<double>::infinity(), freedom};
  for (const double shared : shares) {
    std::array<double, sways.size()> deviance{};
    for (const std::vector<RimResidual>& sides : residuals) {
      const ViewDeviance view(sides, shared);
      for (std::size_t i = 0; i < sways.size(); ++i) deviance[i] += view.at(sways[i], scale);
    }
    for (std::size_t i = 0; i < sways.size(); ++i) {
      if (deviance[i] < best.deviance) best = {noise_of(shared, sways[i]), deviance[i], freedom};
    }
  }
  return best;
}

RimErrors fitted_errors(RimResiduals residuals, const RimFreedom& free) {
  RimErrors errors = likeliest_errors(residuals);
  for (int round = 0; round < 2; ++round) {
    const Vector9d x = fit(residuals, free, errors.noise.shared);
    for (std::vector<RimResidual>& sides : residuals) {
      for (RimResidual& side : sides) side.off += side.by_common * x;
    }
    errors = likeliest_errors(residuals);
  }
  return errors;
}

}  // namespace ca2
