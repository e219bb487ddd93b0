#include "core/intrinsics/intrinsics_bundle.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double huber_cost(double length, double limit) {
  return length <= limit ? 0.5 * length * length : limit * (length - 0.5 * limit);
}

/// Solves H x = b for a symmetric H whose unknowns have very different units (px against distortion): scaled
/// to a unit diagonal first. Nothing when it is not positive definite.
std::optional<Eigen::MatrixXd> solve_scaled(const Eigen::MatrixXd& H, const Eigen::MatrixXd& b) {
  if (!(H.diagonal().minCoeff() > 0)) return std::nullopt;
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  if (llt.info() != Eigen::Success) return std::nullopt;
  return Eigen::MatrixXd(scale.asDiagonal() * llt.solve(scale.asDiagonal() * b));
}

}  // namespace

std::optional<Eigen::Vector2d> whitened_residual(const Camera& camera, const Pose& T_camera_board,
                                                 const BundleCorner& corner) {
  const auto pixel = camera.project(T_camera_board * corner.p_board);
  if (!pixel) return std::nullopt;
  return Eigen::Vector2d(corner.whitener * (*pixel - corner.pixel));
}

double IntrinsicsBundle::linearize(const State& state) {
  const Eigen::Index n = state.camera.parameters.size();
  H_.setZero(n, n);
  g_.setZero(n);
  blocks_.resize(views_.size());
  double total = 0;
  ProjectionJacobian by;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    Block& block = blocks_[i];
    block.H.setZero();
    block.g.setZero();
    block.coupling.setZero(n, 6);
    if (!views_[i].used) continue;
    const Pose& pose = state.poses[i];
    for (const BundleCorner& corner : views_[i].corners) {
      if (!corner.active) continue;
      const auto pixel = state.camera.project(pose * corner.p_board, &by);
      if (!pixel) return infinity;
      const Eigen::Vector2d r = corner.whitener * (*pixel - corner.pixel);
      const double length = r.norm();
      total += huber_cost(length, huber_);
      const double weight = length <= huber_ ? 1 : huber_ / length;
      // Right perturbation: d(T p) = R ([-p]x w + v).
      Eigen::Matrix<double, 3, 6> by_pose;
      by_pose << -pose.R * skew(corner.p_board), pose.R;
      const Eigen::Matrix<double, 2, 6> J_pose = corner.whitener * by.point * by_pose;
      by.parameters = corner.whitener * by.parameters;
      H_.noalias() += weight * by.parameters.transpose() * by.parameters;
      g_.noalias() += weight * by.parameters.transpose() * r;
      block.H.noalias() += weight * J_pose.transpose() * J_pose;
      block.g.noalias() += weight * J_pose.transpose() * r;
      block.coupling.noalias() += weight * by.parameters.transpose() * J_pose;
    }
  }
  return total;
}

double IntrinsicsBundle::cost(const State& state) const {
  if (state.camera.model->invalid(state.camera.parameters)) return infinity;
  double total = 0;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (!views_[i].used) continue;
    for (const BundleCorner& corner : views_[i].corners) {
      if (!corner.active) continue;
      const auto residual = whitened_residual(state.camera, state.poses[i], corner);
      if (!residual) return infinity;
      total += huber_cost(residual->norm(), huber_);
    }
  }
  return total;
}

bool IntrinsicsBundle::reduce(double damping, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
  H = H_;
  H.diagonal() *= 1 + damping;
  g = g_;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (!views_[i].used) continue;
    Matrix6d pose_H = blocks_[i].H;
    pose_H.diagonal() *= 1 + damping;
    const Eigen::LLT<Matrix6d> llt(pose_H);
    if (llt.info() != Eigen::Success) return false;
    H.noalias() -= blocks_[i].coupling * llt.solve(blocks_[i].coupling.transpose());
    g.noalias() -= blocks_[i].coupling * llt.solve(blocks_[i].g);
  }
  return true;
}

std::optional<Eigen::VectorXd> IntrinsicsBundle::step(double damping) const {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  if (!reduce(damping, H, g)) return std::nullopt;
  const auto camera_step = solve_scaled(H, -g);
  if (!camera_step) return std::nullopt;
  const Eigen::Index n = g.size();
  Eigen::VectorXd all = Eigen::VectorXd::Zero(n + 6 * static_cast<Eigen::Index>(views_.size()));
  all.head(n) = *camera_step;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (!views_[i].used) continue;
    Matrix6d pose_H = blocks_[i].H;
    pose_H.diagonal() *= 1 + damping;
    const Vector6d right = blocks_[i].g + blocks_[i].coupling.transpose() * all.head(n);
    all.segment<6>(n + 6 * static_cast<Eigen::Index>(i)) = -pose_H.llt().solve(right);
  }
  return all;
}

double IntrinsicsBundle::predicted_decrease(const Eigen::VectorXd& step) const {
  const Eigen::Index n = g_.size();
  const Eigen::VectorXd c = step.head(n);
  double decrease = -g_.dot(c) - 0.5 * c.dot(H_ * c);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Vector6d p = step.segment<6>(n + 6 * static_cast<Eigen::Index>(i));
    decrease -= blocks_[i].g.dot(p) + 0.5 * p.dot(blocks_[i].H * p) + c.dot(blocks_[i].coupling * p);
  }
  return decrease;
}

IntrinsicsBundle::State IntrinsicsBundle::moved(const State& state, const Eigen::VectorXd& step) const {
  State next = state;
  const Eigen::Index n = g_.size();
  next.camera.parameters += step.head(n);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (!views_[i].used) continue;
    next.poses[i] = state.poses[i].perturbed(step.segment<6>(n + 6 * static_cast<Eigen::Index>(i)));
    next.poses[i].R = nearest_rotation(next.poses[i].R);
  }
  return next;
}

std::optional<Eigen::MatrixXd> IntrinsicsBundle::information() const {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  if (!reduce(0, H, g)) return std::nullopt;
  return H;
}

}  // namespace ca2
