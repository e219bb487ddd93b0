#include "core/solve/joint_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/adjoint.h"

namespace ca2 {
namespace {

/// Holds a value that has no freedom: 1e-9 of its unit.
constexpr double held = 1e18;

}  // namespace

JointProblem::JointProblem(const JointInput& input)
    : input_(input),
      cameras_(static_cast<int>(input.cameras.size())),
      lidars_(static_cast<int>(input.range_sigma.size())),
      lidar_poses_(6 * (cameras_ - 1)),
      intrinsics_(lidar_poses_ + 6 * lidars_),
      biases_(intrinsics_ + 4 * cameras_),
      globals_(biases_ + 3 * lidars_),
      views_(input.views.size()) {
  for (const JointView& view : input.views) {
    auto& by_camera = whitening_.emplace_back();
    for (const std::vector<Corner>& corners : view.corners) {
      auto& list = by_camera.emplace_back();
      for (const Corner& corner : corners) {
        list.push_back(corner.covariance.inverse().llt().matrixU());
      }
    }
  }
}

const Pose& JointProblem::sensor_pose(const State& state, int sensor) const {
  return sensor < cameras_ ? state.T_ref_camera[static_cast<std::size_t>(sensor)]
                           : state.T_ref_lidar[static_cast<std::size_t>(sensor - cameras_)];
}

int JointProblem::sensor_index(int sensor) const {
  if (sensor == 0) return -1;
  return sensor < cameras_ ? camera_pose_index(sensor) : lidar_pose_index(sensor - cameras_);
}

double JointProblem::add_corners(const State& state, std::size_t view, int camera,
                                 ViewEquations* equations) const {
  const auto c = static_cast<std::size_t>(camera);
  const std::vector<Corner>& corners = input_.views[view].corners[c];
  if (corners.empty()) return 0;
  const Camera& model = state.cameras[c];
  const Pose T_camera_board = state.T_ref_camera[c].inverse() * state.T_ref_board[view];
  // Local unknowns: board pose (6), camera pose (6), fx fy cx cy (4).
  Eigen::Matrix<double, 16, 16> H = Eigen::Matrix<double, 16, 16>::Zero();
  Eigen::Matrix<double, 16, 1> g = Eigen::Matrix<double, 16, 1>::Zero();
  double cost = 0;
  ProjectionJacobian jacobian;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& xy = input_.board_corners[static_cast<std::size_t>(corners[i].id)];
    const Eigen::Vector3d p_board(xy.x(), xy.y(), 0);
    const Eigen::Vector3d p = T_camera_board * p_board;
    const std::optional<Eigen::Vector2d> pixel = model.project(p, equations ? &jacobian : nullptr);
    if (!pixel) return std::numeric_limits<double>::infinity();
    const Eigen::Matrix2d& W = whitening_[view][c][i];
    const Eigen::Vector2d e = W * (*pixel - corners[i].pixel);
    const double norm = e.norm();
    const double k = input_.corner_huber;
    const double weight = norm <= k ? 1 : k / norm;
    cost += norm <= k ? 0.5 * norm * norm : k * (norm - 0.5 * k);
    if (!equations) continue;
    const Eigen::Matrix<double, 2, 3> by_point = W * jacobian.point;
    Eigen::Matrix<double, 2, 16> J;
    J.block<2, 3>(0, 0) = -by_point * T_camera_board.R * skew(p_board);
    J.block<2, 3>(0, 3) = by_point * T_camera_board.R;
    J.block<2, 3>(0, 6) = by_point * skew(p);
    J.block<2, 3>(0, 9) = -by_point;
    J.block<2, 4>(0, 12) = W * jacobian.parameters.leftCols<4>();
    H.noalias() += weight * J.transpose() * J;
    g.noalias() += weight * J.transpose() * e;
  }
  if (!equations) return cost;
  const int pose = sensor_index(camera);
  const int intrinsics = intrinsics_index(camera);
  equations->Hvv += H.block<6, 6>(0, 0);
  equations->gv += g.head<6>();
  equations->Hvg.middleCols<4>(intrinsics) += H.block<6, 4>(0, 12);
  equations->Hgg.block<4, 4>(intrinsics, intrinsics) += H.block<4, 4>(12, 12);
  equations->gg.segment<4>(intrinsics) += g.tail<4>();
  if (pose >= 0) {
    equations->Hvg.middleCols<6>(pose) += H.block<6, 6>(0, 6);
    equations->Hgg.block<6, 6>(pose, pose) += H.block<6, 6>(6, 6);
    equations->Hgg.block<6, 4>(pose, intrinsics) += H.block<6, 4>(6, 12);
    equations->Hgg.block<4, 6>(intrinsics, pose) += H.block<4, 6>(12, 6);
    equations->gg.segment<6>(pose) += g.segment<6>(6);
  }
  return cost;
}

double JointProblem::add_ranges(const State& state, std::size_t view, int lidar,
                                ViewEquations* equations) const {
  const auto l = static_cast<std::size_t>(lidar);
  const std::optional<RangeSums>& sums = input_.views[view].ranges[l];
  if (!sums) return 0;
  const Pose T_lidar_board = state.T_ref_lidar[l].inverse() * state.T_ref_board[view];
  const Eigen::Vector3d m = T_lidar_board.R.col(2);
  const double h = m.dot(T_lidar_board.t);
  if (std::abs(h) < 1e-6) return std::numeric_limits<double>::infinity();
  const double scale = 1 / (input_.range_sigma[l] * input_.range_sigma[l]);
  const Vector5d z = sums->z(m / h, state.range_bias[l], state.range_slope[l]);
  const double cost = scale * sums->at(z);
  if (!equations) return cost;
  // q = m / h; dq = dm / h - m dh / h^2. By the board pose: dm = -R [e3]x dr, dh = e3.dt (turning about the
  // board's own origin moves no point of the axis m through it: dh = dm.t). By the LiDAR's pose: dm = [m]x
  // dr, dh = -m.dt.
  Eigen::Matrix<double, 5, 14> D =
      Eigen::Matrix<double, 5, 14>::Zero();  // of z by (board pose, LiDAR pose, bias, slope)
  const Eigen::Matrix3d by_board = -T_lidar_board.R * skew(Eigen::Vector3d::UnitZ());
  D.block<3, 3>(0, 0) = by_board / h - m * (T_lidar_board.t.transpose() * by_board) / (h * h);
  D.block<3, 3>(0, 3) = -m * Eigen::RowVector3d::UnitZ() / (h * h);
  D.block<3, 3>(0, 6) = skew(m) / h;
  D.block<3, 3>(0, 9) = m * m.transpose() / (h * h);
  D(3, 12) = D(4, 13) = 1;
  const Eigen::Matrix<double, 14, 14> H = scale * D.transpose() * sums->H * D;
  const Eigen::Matrix<double, 14, 1> g = scale * D.transpose() * (sums->gradient + sums->H * z);
  const int pose = lidar_pose_index(lidar);
  const int bias = bias_index(lidar);
  const int slope = slope_index(lidar);
  equations->Hvv += H.block<6, 6>(0, 0);
  equations->gv += g.head<6>();
  equations->Hvg.middleCols<6>(pose) += H.block<6, 6>(0, 6);
  equations->Hgg.block<6, 6>(pose, pose) += H.block<6, 6>(6, 6);
  equations->gg.segment<6>(pose) += g.segment<6>(6);
  for (const auto& [index, i] : {std::pair{bias, 12}, {slope, 13}}) {
    equations->Hvg.col(index) += H.block<6, 1>(0, i);
    equations->Hgg.block<6, 1>(pose, index) += H.block<6, 1>(6, i);
    equations->Hgg.block<1, 6>(index, pose) += H.block<1, 6>(i, 6);
    equations->Hgg(index, index) += H(i, i);
    equations->gg(index) += g(i);
  }
  equations->Hgg(bias, slope) += H(12, 13);
  equations->Hgg(slope, bias) += H(13, 12);
  return cost;
}

void JointProblem::clear(ViewEquations& equations) const {
  equations.Hvv.setZero();
  equations.Hvg.setZero(6, globals_);
  equations.Hgg.setZero(globals_, globals_);
  equations.gg.setZero(globals_);
  equations.gv.setZero();
}

double JointProblem::add_view(const State& state, std::size_t view, ViewEquations* equations) const {
  if (equations) clear(*equations);
  double cost = 0;
  for (int c = 0; c < cameras_; ++c) cost += add_corners(state, view, c, equations);
  for (int l = 0; l < lidars_; ++l) {
    cost += add_ranges(state, view, l, equations);
    cost += add_edges(state, view, l, equations);
  }
  return cost;
}

double JointProblem::add_priors(const State& state, Eigen::MatrixXd* H, Eigen::VectorXd* g) const {
  double cost = 0;
  const auto add = [&](int index, double error, double information) {
    cost += 0.5 * information * error * error;
    if (!H) return;
    (*H)(index, index) += information;
    (*g)(index) += information * error;
  };
  for (int c = 0; c < cameras_; ++c) {
    const CameraParameters& given = input_.cameras[static_cast<std::size_t>(c)].parameters;
    const CameraParameters& now = state.cameras[static_cast<std::size_t>(c)].parameters;
    for (int k = 0; k < 4; ++k) {
      const double sigma = input_.prior_intrinsics[static_cast<std::size_t>(c)](k);
      add(intrinsics_index(c) + k, now(k) - given(k), sigma > 0 ? 1 / (sigma * sigma) : held);
    }
  }
  for (int l = 0; l < lidars_; ++l) {
    add(bias_index(l), state.range_bias[static_cast<std::size_t>(l)],
        input_.prior_bias > 0 ? 1 / (input_.prior_bias * input_.prior_bias) : held);
    const double slope = input_.prior_range_slope[static_cast<std::size_t>(l)];
    add(slope_index(l), state.range_slope[static_cast<std::size_t>(l)],
        slope > 0 ? 1 / (slope * slope) : held);
    add(dilation_index(l), state.dilation[static_cast<std::size_t>(l)],
        input_.prior_dilation > 0 ? 1 / (input_.prior_dilation * input_.prior_dilation) : held);
  }
  for (const RelativePrior& prior : input_.relative) {
    // T_a_b now = T_ref_a^-1 T_ref_b; perturbing b adds d, perturbing a adds -Ad(T_b_a) d.
    const Pose T_a_b = sensor_pose(state, prior.a).inverse() * sensor_pose(state, prior.b);
    const Vector6d e = prior.T_a_b.difference(T_a_b);
    cost += 0.5 * e.dot(prior.information * e);
    if (!H) continue;
    Eigen::Matrix<double, 6, Eigen::Dynamic> J = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, globals_);
    // Of e by a perturbation of b: the error's own rotation turns it.
    Matrix6d by_b = Matrix6d::Zero();
    by_b.topLeftCorner<3, 3>() = so3_right_jacobian(e.head<3>()).inverse();
    by_b.bottomRightCorner<3, 3>() = prior.T_a_b.R.transpose() * T_a_b.R;
    if (sensor_index(prior.b) >= 0) J.middleCols<6>(sensor_index(prior.b)) += by_b;
    if (sensor_index(prior.a) >= 0) J.middleCols<6>(sensor_index(prior.a)) -= by_b * adjoint(T_a_b.inverse());
    *H += J.transpose() * prior.information * J;
    *g += J.transpose() * prior.information * e;
  }
  return cost;
}

double JointProblem::linearize(const State& state) {
  double cost = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) cost += add_view(state, v, &views_[v]);
  prior_H_.setZero(globals_, globals_);
  prior_g_.setZero(globals_);
  return cost + add_priors(state, &prior_H_, &prior_g_);
}

double JointProblem::cost(const State& state) const {
  double cost = add_priors(state, nullptr, nullptr);
  for (std::size_t v = 0; v < views_.size(); ++v) cost += add_view(state, v, nullptr);
  return cost;
}

std::optional<Eigen::VectorXd> JointProblem::step(double damping) const {
  Eigen::MatrixXd S = prior_H_;
  Eigen::VectorXd r = prior_g_;
  S.diagonal() *= 1 + damping;
  std::vector<Eigen::LDLT<Matrix6d>> factors;
  factors.reserve(views_.size());
  for (const ViewEquations& view : views_) {
    Matrix6d Hvv = view.Hvv;
    Hvv.diagonal() +=
        damping * view.Hvv.diagonal() + Vector6d::Constant(1e-12 * view.Hvv.diagonal().maxCoeff());
    factors.emplace_back(Hvv);
    if (factors.back().info() != Eigen::Success) return std::nullopt;
    const Eigen::Matrix<double, 6, Eigen::Dynamic> solved = factors.back().solve(view.Hvg);
    S += view.Hgg;
    S.diagonal() += damping * view.Hgg.diagonal();
    S.noalias() -= view.Hvg.transpose() * solved;
    r += view.gg;
    r.noalias() -= solved.transpose() * view.gv;
  }
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(S);
  if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return std::nullopt;
  Eigen::VectorXd step(globals_ + 6 * static_cast<Eigen::Index>(views_.size()));
  step.head(globals_) = -ldlt.solve(r);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    step.segment<6>(globals_ + 6 * static_cast<Eigen::Index>(v)) =
        -factors[v].solve(views_[v].gv + views_[v].Hvg * step.head(globals_));
  }
  return step;
}

double JointProblem::predicted_decrease(const Eigen::VectorXd& step) const {
  const Eigen::VectorXd dg = step.head(globals_);
  double model = prior_g_.dot(dg) + 0.5 * dg.dot(prior_H_ * dg);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const Vector6d dv = step.segment<6>(globals_ + 6 * static_cast<Eigen::Index>(v));
    const ViewEquations& view = views_[v];
    model += view.gg.dot(dg) + view.gv.dot(dv) + 0.5 * dg.dot(view.Hgg * dg) + 0.5 * dv.dot(view.Hvv * dv) +
             dv.dot(view.Hvg * dg);
  }
  return -model;
}

JointState JointProblem::moved(const State& state, const Eigen::VectorXd& step) const {
  State next = state;
  for (int c = 0; c < cameras_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (c > 0) next.T_ref_camera[i] = state.T_ref_camera[i].perturbed(step.segment<6>(camera_pose_index(c)));
    next.cameras[i].parameters.head<4>() += step.segment<4>(intrinsics_index(c));
  }
  for (int l = 0; l < lidars_; ++l) {
    const auto i = static_cast<std::size_t>(l);
    next.T_ref_lidar[i] = state.T_ref_lidar[i].perturbed(step.segment<6>(lidar_pose_index(l)));
    next.range_bias[i] += step(bias_index(l));
    next.range_slope[i] += step(slope_index(l));
    next.dilation[i] += step(dilation_index(l));
  }
  for (std::size_t v = 0; v < views_.size(); ++v) {
    next.T_ref_board[v] =
        state.T_ref_board[v].perturbed(step.segment<6>(globals_ + 6 * static_cast<Eigen::Index>(v)));
  }
  return next;
}

double JointProblem::add_edges(const State& state, std::size_t view, int lidar,
                               ViewEquations* equations) const {
  const auto l = static_cast<std::size_t>(lidar);
  const std::vector<EdgeSums>& edges = input_.views[view].edges[l];
  if (edges.empty()) return 0;
  const Pose T_lidar_board = state.T_ref_lidar[l].inverse() * state.T_ref_board[view];
  Eigen::Matrix<double, 13, 13> H =
      Eigen::Matrix<double, 13, 13>::Zero();  // board pose, LiDAR pose, dilation
  Eigen::Matrix<double, 13, 1> g = Eigen::Matrix<double, 13, 1>::Zero();
  double cost = 0;
  for (const EdgeSums& edge : edges) {
    const Eigen::Vector4d z = edge.at(T_lidar_board, state.dilation[l]);
    const Eigen::Vector4d Hz = edge.H * z;
    cost += 0.5 * z.dot(Hz);
    if (!equations) continue;
    const Eigen::Vector3d a = T_lidar_board * edge.a;
    const Eigen::Vector3d b = T_lidar_board * edge.b;
    const Eigen::Vector3d normal = z.head<3>();
    Eigen::Matrix<double, 3, 12> by_a, by_b;  // of the ends, by board pose and LiDAR pose
    by_a << -T_lidar_board.R * skew(edge.a), T_lidar_board.R, skew(a), -Eigen::Matrix3d::Identity();
    by_b << -T_lidar_board.R * skew(edge.b), T_lidar_board.R, skew(b), -Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 4, 13> J = Eigen::Matrix<double, 4, 13>::Zero();
    J.topLeftCorner<3, 12>() = (Eigen::Matrix3d::Identity() - normal * normal.transpose()) /
                               a.cross(b).norm() * (skew(a) * by_b - skew(b) * by_a);
    J(3, 12) = 1;
    H.noalias() += J.transpose() * edge.H * J;
    g.noalias() += J.transpose() * Hz;
  }
  if (!equations) return cost;
  const int pose = lidar_pose_index(lidar);
  const int dilation = dilation_index(lidar);
  equations->Hvv += H.block<6, 6>(0, 0);
  equations->gv += g.head<6>();
  equations->Hvg.middleCols<6>(pose) += H.block<6, 6>(0, 6);
  equations->Hvg.col(dilation) += H.block<6, 1>(0, 12);
  equations->Hgg.block<6, 6>(pose, pose) += H.block<6, 6>(6, 6);
  equations->Hgg.block<6, 1>(pose, dilation) += H.block<6, 1>(6, 12);
  equations->Hgg.block<1, 6>(dilation, pose) += H.block<1, 6>(12, 6);
  equations->Hgg(dilation, dilation) += H(12, 12);
  equations->gg.segment<6>(pose) += g.segment<6>(6);
  equations->gg(dilation) += g(12);
  return cost;
}

Misfit JointProblem::misfit(const State& state, std::size_t view) const {
  // A sensor's Newton decrement, twice, is what its own cost could still fall if it had the board pose to
  // itself. Summed over sensors whose gradients cancel this is their disagreement over its covariance.
  const auto decrement = [](const auto& H, const auto& g) { return g.dot(H.ldlt().solve(g)); };
  Misfit misfit;
  ViewEquations equations;
  Matrix6d H_cameras = Matrix6d::Zero();
  Vector6d g_cameras = Vector6d::Zero();
  for (int c = 0; c < cameras_; ++c) {
    if (input_.views[view].corners[static_cast<std::size_t>(c)].empty()) continue;
    clear(equations);
    if (!std::isfinite(add_corners(state, view, c, &equations))) {
      misfit.lidars = misfit.cameras = std::numeric_limits<double>::infinity();
      return misfit;
    }
    misfit.cameras += decrement(equations.Hvv, equations.gv);
    misfit.camera_freedom += 6;
    H_cameras += equations.Hvv;
    g_cameras += equations.gv;
  }
  if (misfit.camera_freedom > 0) {
    const double together = decrement(H_cameras, g_cameras);
    misfit.cameras = std::max(0.0, misfit.cameras - together);
    misfit.camera_freedom -= 6;
    misfit.lidars = together;
  }
  for (int l = 0; l < lidars_; ++l) {
    const auto i = static_cast<std::size_t>(l);
    const std::optional<RangeSums>& sums = input_.views[view].ranges[i];
    if (!sums) continue;
    const Pose T_lidar_board = state.T_ref_lidar[i].inverse() * state.T_ref_board[view];
    const Vector5d z =
        sums->z(inverse_plane(board_plane(T_lidar_board)), state.range_bias[i], state.range_slope[i]);
    const Eigen::Vector3d gradient = (sums->gradient + sums->H * z).head<3>();
    const Eigen::Matrix3d H = sums->H.topLeftCorner<3, 3>();
    misfit.lidars += decrement(H, gradient) / (input_.range_sigma[i] * input_.range_sigma[i]);
    misfit.lidar_freedom += 3;
  }
  // Without a camera the first plane only says where the board is.
  if (misfit.camera_freedom == 0 && H_cameras.isZero()) {
    misfit.lidar_freedom = std::max(0, misfit.lidar_freedom - 3);
  }
  return misfit;
}

void JointProblem::view_share(std::size_t view, Eigen::MatrixXd& information,
                              Eigen::VectorXd& gradient) const {
  const ViewEquations& equations = views_[view];
  Matrix6d Hvv = equations.Hvv;
  Hvv.diagonal().array() += 1e-12 * equations.Hvv.diagonal().maxCoeff();
  const Eigen::LDLT<Matrix6d> ldlt(Hvv);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> solved = ldlt.solve(equations.Hvg);
  information = equations.Hgg - equations.Hvg.transpose() * solved;
  gradient = equations.gg - solved.transpose() * equations.gv;
}

Eigen::MatrixXd JointProblem::information() const {
  Eigen::MatrixXd total = prior_H_;
  Eigen::MatrixXd share;
  Eigen::VectorXd gradient;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    view_share(v, share, gradient);
    total += share;
  }
  return total;
}

}  // namespace ca2
