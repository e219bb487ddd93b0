#include "core/solve/corner_field.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

/// Of the error from which the cost is linear: up to here a corner's cost is held for quadratic while the
/// board moves within reach and the noise is estimated anew.
constexpr double certain = 0.75;

double huber_cost(double norm, double k) {
  return norm <= k ? 0.5 * norm * norm : k * (norm - 0.5 * k);
}

}  // namespace

CornerField::CornerField(std::span<const Corner> corners, std::span<const Eigen::Vector2d> positions) {
  corners_.reserve(corners.size());
  for (const Corner& corner : corners) {
    const Eigen::Vector2d& xy = positions[static_cast<std::size_t>(corner.id)];
    corners_.push_back({corner.id,
                        {xy.x(), xy.y(), 0},
                        corner.pixel,
                        corner.covariance.llt().matrixL().solve(Eigen::Matrix2d::Identity())});
  }
  rows_.resize(corners.size());
}

Vector10d CornerField::way_to(const Camera& camera, const Pose& T_camera_board) const {
  Vector10d way;
  way << T_camera_board_.difference(T_camera_board), camera.parameters.head<4>() - intrinsics_;
  return way;
}

bool CornerField::close(const Vector10d& way, const Pose& T_camera_board) const {
  return way.head<3>().norm() <= reach_ && way.segment<3>(3).norm() <= reach_ * T_camera_board.t.norm() &&
         way.tail<4>().lpNorm<Eigen::Infinity>() <= intrinsics_reach;
}

bool CornerField::project(const Camera& camera, const Pose& T_camera_board) {
  approached_ = false;
  ProjectionJacobian jacobian;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Seen& corner = corners_[i];
    Row& row = rows_[i];
    const auto pixel = camera.project(T_camera_board * corner.p_board, &jacobian);
    if (!pixel) return false;
    row.e = corner.whitening * (*pixel - corner.pixel);
    const Eigen::Matrix<double, 2, 3> by_translation = corner.whitening * jacobian.point * T_camera_board.R;
    row.J.topRows<3>() = skew(corner.p_board) * by_translation.transpose();
    row.J.middleRows<3>(3) = by_translation.transpose();
    row.J.bottomRows<4>() = (corner.whitening * jacobian.parameters.leftCols<4>()).transpose();
  }
  T_camera_board_ = T_camera_board;
  intrinsics_ = camera.parameters.head<4>();
  approached_ = true;
  limit_ = 0;
  return true;
}

void CornerField::settle(double limit) {
  settled_ = {};
  settled_up_to_ = 0;
  limit_ = limit;
  single_.clear();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const double squared = row.e.squaredNorm();
    if (squared > limit * limit) {
      single_.push_back(i);
      continue;
    }
    settled_up_to_ = std::max(settled_up_to_, squared);
    settled_.cost += 0.5 * squared;
    settled_.g.noalias() += row.J.lazyProduct(row.e);
    settled_.H.noalias() += row.J.lazyProduct(row.J.transpose());
  }
  settled_up_to_ = std::sqrt(settled_up_to_);
}

bool CornerField::approach(const Camera& camera, const Pose& T_camera_board, double scale, double huber,
                           double reach) {
  reach_ = reach;
  if (!approached_ || !close(way_to(camera, T_camera_board), T_camera_board)) {
    if (!project(camera, T_camera_board)) return false;
  }
  const double limit = certain * huber * scale;
  if (limit_ == 0 || settled_up_to_ > 1.1 * limit || limit_ < 0.8 * limit) settle(limit);
  return true;
}

SensorEquations CornerField::equations(const Camera& camera, const Pose& T_camera_board, double scale,
                                       double huber) const {
  const Vector10d way = way_to(camera, T_camera_board);
  SensorEquations sum = settled_;
  const Vector10d H_way = settled_.H.lazyProduct(way);
  sum.cost += settled_.g.dot(way) + 0.5 * way.dot(H_way);
  sum.g += H_way;
  for (const std::size_t i : single_) {
    const Row& row = rows_[i];
    const Eigen::Vector2d e = row.e + row.J.transpose().lazyProduct(way);
    const double norm = e.norm();
    const double weight = norm <= huber * scale ? 1 : huber * scale / norm;
    sum.cost += huber_cost(norm, huber * scale);
    sum.g.noalias() += row.J.lazyProduct(weight * e);
    sum.H.noalias() += weight * row.J.lazyProduct(row.J.transpose());
  }
  const double information = 1 / (scale * scale);
  sum.cost *= information;
  sum.g *= information;
  sum.H *= information;
  return sum;
}

double CornerField::cost(const Camera& camera, const Pose& T_camera_board, double scale, double huber) const {
  double sum = 0;
  const Vector10d way = approached_ ? way_to(camera, T_camera_board) : Vector10d::Zero();
  if (approached_ && close(way, T_camera_board)) {
    sum = settled_.cost + settled_.g.dot(way) + 0.5 * way.dot(settled_.H.lazyProduct(way));
    for (const std::size_t i : single_) {
      const Row& row = rows_[i];
      sum += huber_cost((row.e + row.J.transpose().lazyProduct(way)).norm(), huber * scale);
    }
  } else {
    for (const Seen& corner : corners_) {
      const auto pixel = camera.project(T_camera_board * corner.p_board);
      if (!pixel) return std::numeric_limits<double>::infinity();
      sum += huber_cost((corner.whitening * (*pixel - corner.pixel)).norm(), huber * scale);
    }
  }
  return sum / (scale * scale);
}

Eigen::Matrix2Xd CornerField::errors(const Camera& camera, const Pose& T_camera_board) const {
  const Vector10d way = way_to(camera, T_camera_board);
  Eigen::Matrix2Xd errors(2, static_cast<Eigen::Index>(rows_.size()));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    errors.col(static_cast<Eigen::Index>(i)) = rows_[i].e + rows_[i].J.transpose().lazyProduct(way);
  }
  return errors;
}

Eigen::Matrix2Xd CornerField::errors_about_own_pose(const Camera& camera, const Pose& T_camera_board) const {
  Eigen::Matrix2Xd errors = this->errors(camera, T_camera_board);
  Matrix6d H = settled_.H.topLeftCorner<6, 6>();
  for (const std::size_t i : single_) {
    H.noalias() += rows_[i].J.topRows<6>().lazyProduct(rows_[i].J.topRows<6>().transpose());
  }
  Vector6d g = Vector6d::Zero();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    g.noalias() += rows_[i].J.topRows<6>().lazyProduct(errors.col(static_cast<Eigen::Index>(i)));
  }
  const Vector6d pull = H.ldlt().solve(g);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    errors.col(static_cast<Eigen::Index>(i)) -= rows_[i].J.topRows<6>().transpose().lazyProduct(pull);
  }
  return errors;
}

double CornerField::rms(const Camera& camera, const Pose& T_camera_board) const {
  const Eigen::Matrix2Xd errors = this->errors(camera, T_camera_board);
  double squares = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    squares += corners_[i]
                   .whitening.triangularView<Eigen::Lower>()
                   .solve(Eigen::Vector2d(errors.col(static_cast<Eigen::Index>(i))))
                   .squaredNorm();
  }
  return std::sqrt(squares / std::max<double>(1, static_cast<double>(corners_.size())));
}

}  // namespace ca2
