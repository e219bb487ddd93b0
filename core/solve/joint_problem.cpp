#include "core/solve/joint_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/geometry/adjoint.h"
#include "core/geometry/scaled_inverse.h"
#include "core/solve/lidar_terms.h"

namespace ca2 {
namespace {

/// Holds a value that has no freedom: 1e-9 of its unit.
constexpr double held = 1e18;

/// Information of a prior with this standard deviation; 0 holds the value.
double known_to(double sigma) {
  return sigma > 0 ? 1 / (sigma * sigma) : held;
}

/// Where every camera's intrinsics begin, from `first` on, and where the last one's end.
std::vector<int> intrinsics_places(const JointInput& input, int first) {
  std::vector<int> places{first};
  for (const CameraParameters& sigma : input.prior_intrinsics)
    places.push_back(places.back() + static_cast<int>(sigma.size()));
  return places;
}

}  // namespace

JointProblem::JointProblem(const JointInput& input)
    : input_(input),
      cameras_(static_cast<int>(input.cameras.size())),
      lidars_(static_cast<int>(input.range_sigma.size())),
      lidar_poses_(6 * (cameras_ - 1)),
      intrinsics_(intrinsics_places(input, lidar_poses_ + 6 * lidars_)),
      stretch_(intrinsics_.back()),
      biases_(stretch_ + (input.prior_stretch > 0 ? 2 : 0)),
      globals_(biases_ + 4 * lidars_ + 1),
      views_(input.views.size()),
      eliminated_(input.views.size()) {
  for (const JointView& view : input.views) {
    auto& by_camera = corners_.emplace_back();
    for (std::size_t c = 0; c < view.corners.size(); ++c)
      by_camera.emplace_back(view.corners[c], input.board_corners,
                             CornerUnknowns{free_intrinsics(static_cast<int>(c)), stretch_free()});
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

Pose JointProblem::sensor_board(const State& state, int sensor, std::size_t view) const {
  return sensor_pose(state, sensor).inverse() * state.T_ref_board[view];
}

double JointProblem::corner_scale(int camera) const {
  return input_.corner_scale.empty() ? 1 : input_.corner_scale[static_cast<std::size_t>(camera)];
}

double JointProblem::lidar_cost(const State& state, std::size_t view, int lidar,
                                SensorEquations* equations) const {
  const auto l = static_cast<std::size_t>(lidar);
  const std::optional<RangeSums>& sums = input_.views[view].ranges[l];
  const std::vector<EdgeSums>& edges = input_.views[view].edges[l];
  if (!sums && edges.empty()) return 0;
  const Pose T_lidar_board = sensor_board(state, cameras_ + lidar, view);
  const LidarErrors errors{state.range_bias[l], state.dilation[l], state.rim_depth, state.range_slope[l]};
  double cost = add_edges(edges, input_.edge_sway[l], T_lidar_board, errors, equations);
  if (sums) cost += add_ranges(*sums, input_.range_sigma[l], T_lidar_board, errors, equations);
  return cost;
}

template <typename Equations>
void JointProblem::add_sensor(const Equations& sensor, const Pose& T_sensor_board, int pose,
                              std::span<const int> numbers, ViewEquations& equations,
                              DenseNormalEquations& into) {
  const Matrix6d H = sensor.H.template topLeftCorner<6, 6>();
  const Vector6d g = sensor.g.template head<6>();
  equations.Hvv += H;
  equations.gv += g;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const auto from = static_cast<Eigen::Index>(6 + k);
    equations.Hvg.col(numbers[k]) += sensor.H.template block<6, 1>(0, from);
    into.g(numbers[k]) += sensor.g(from);
    for (std::size_t j = 0; j < numbers.size(); ++j)
      into.H(numbers[k], numbers[j]) += sensor.H(from, static_cast<Eigen::Index>(6 + j));
  }
  if (pose < 0) return;
  // T_sensor_board = T_ref_sensor^-1 T_ref_board: perturbing the sensor by d perturbs it by
  // -Ad(T_board_sensor) d.
  const Matrix6d A = -adjoint(T_sensor_board.inverse());
  const Matrix6d HA = H * A;
  equations.Hvg.middleCols<6>(pose) += HA;
  into.H.block<6, 6>(pose, pose) += A.transpose() * HA;
  into.g.segment<6>(pose) += A.transpose() * g;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const Vector6d mixed = A.transpose() * sensor.H.template block<6, 1>(0, static_cast<Eigen::Index>(6 + k));
    into.H.block<6, 1>(pose, numbers[k]) += mixed;
    into.H.block<1, 6>(numbers[k], pose) += mixed.transpose();
  }
}

double JointProblem::linearize_view(const State& state, std::size_t view, DenseNormalEquations& into) {
  ViewEquations& equations = views_[view];
  equations.clear(globals_);
  double cost = 0;
  for (int c = 0; c < cameras_; ++c) {
    CornerField& corners = corners_[view][static_cast<std::size_t>(c)];
    if (corners.empty()) continue;
    const Camera& camera = state.cameras[static_cast<std::size_t>(c)];
    const Pose T_camera_board = sensor_board(state, c, view);
    const CornerModel model{camera, T_camera_board, state.stretch};
    if (!corners.approach(model, corner_scale(c), input_.corner_huber, input_.corner_reach))
      return std::numeric_limits<double>::infinity();
    const CameraEquations sensor = corners.equations(model, corner_scale(c), input_.corner_huber);
    std::array<int, CameraEquations::most - 6> numbers;
    const auto own = numbers.begin() + free_intrinsics(c);
    std::iota(numbers.begin(), own, intrinsics_index(c));
    std::iota(own, own + 2, stretch_index());
    add_sensor(sensor, T_camera_board, sensor_index(c),
               std::span(numbers).first(static_cast<std::size_t>(sensor.g.size() - 6)), equations, into);
    cost += sensor.cost;
  }
  for (int l = 0; l < lidars_; ++l) {
    SensorEquations sensor;
    cost += lidar_cost(state, view, l, &sensor);
    add_sensor(sensor, sensor_board(state, cameras_ + l, view), lidar_pose_index(l),
               std::array{bias_index(l), dilation_index(l), dilation_index(l) + 1, slope_index(l),
                          rim_depth_index()},
               equations, into);
  }
  return cost;
}

double JointProblem::add_priors(const State& state, DenseNormalEquations* equations) const {
  double cost = 0;
  const auto add = [&](int index, double error, double information) {
    cost += 0.5 * information * error * error;
    if (!equations) return;
    equations->H(index, index) += information;
    equations->g(index) += information * error;
  };
  const auto loose = [&](double sigma) { return sigma > 0 && input_.nuisances ? 0 : known_to(sigma); };
  for (int c = 0; c < cameras_; ++c) {
    const CameraParameters& given = input_.cameras[static_cast<std::size_t>(c)].parameters;
    const CameraParameters& now = state.cameras[static_cast<std::size_t>(c)].parameters;
    for (int k = 0; k < free_intrinsics(c); ++k) {
      const double sigma = input_.prior_intrinsics[static_cast<std::size_t>(c)](k);
      add(intrinsics_index(c) + k, now(k) - given(k), loose(sigma));
    }
  }
  for (int k = 0; k < (stretch_free() ? 2 : 0); ++k)
    add(stretch_index() + k, state.stretch(k), loose(input_.prior_stretch));
  for (int l = 0; l < lidars_; ++l) {
    add(bias_index(l), state.range_bias[static_cast<std::size_t>(l)], loose(input_.prior_bias));
    add(slope_index(l), state.range_slope[static_cast<std::size_t>(l)],
        known_to(input_.prior_range_slope[static_cast<std::size_t>(l)]));
    const Dilation& dilation = state.dilation[static_cast<std::size_t>(l)];
    add(dilation_index(l), dilation.angle, known_to(input_.prior_dilation));
    add(margin_index(l), dilation.margin, loose(input_.rim_freedom.margin));
  }
  add(rim_depth_index(), state.rim_depth, loose(input_.rim_freedom.depth));
  if (input_.nuisances) {
    const Eigen::VectorXd d = deviations(state);
    const Eigen::VectorXd pulled = input_.nuisances->information * d - input_.nuisances->pull;
    cost += 0.5 * d.dot(pulled - input_.nuisances->pull);
    if (equations) {
      equations->H.block(intrinsics_index(0), intrinsics_index(0), d.size(), d.size()) +=
          input_.nuisances->information;
      equations->g.segment(intrinsics_index(0), d.size()) += pulled;
    }
  }
  for (const RelativePrior& prior : input_.relative) {
    // T_a_b now = T_ref_a^-1 T_ref_b; perturbing b adds d, perturbing a adds -Ad(T_b_a) d.
    const Pose T_a_b = sensor_pose(state, prior.a).inverse() * sensor_pose(state, prior.b);
    const Vector6d e = prior.T_a_b.difference(T_a_b);
    cost += 0.5 * e.dot(prior.information * e);
    if (!equations) continue;
    Eigen::Matrix<double, 6, Eigen::Dynamic> J = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, globals_);
    // Of e by a perturbation of b: the error's own rotation turns it.
    Matrix6d by_b = Matrix6d::Zero();
    by_b.topLeftCorner<3, 3>() = so3_right_jacobian(e.head<3>()).inverse();
    by_b.bottomRightCorner<3, 3>() = prior.T_a_b.R.transpose() * T_a_b.R;
    if (sensor_index(prior.b) >= 0) J.middleCols<6>(sensor_index(prior.b)) += by_b;
    if (sensor_index(prior.a) >= 0) J.middleCols<6>(sensor_index(prior.a)) -= by_b * adjoint(T_a_b.inverse());
    equations->H += J.transpose() * prior.information * J;
    equations->g += J.transpose() * prior.information * e;
  }
  return cost;
}

double JointProblem::linearize(const State& state) {
  total_.clear(globals_);
  views_cost_ = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) views_cost_ += linearize_view(state, v, total_);
  return renew_priors(state);
}

double JointProblem::renew_priors(const State& state) {
  prior_.clear(globals_);
  return views_cost_ + add_priors(state, &prior_);
}

double JointProblem::cost(const State& state) const {
  double cost = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    for (int c = 0; c < cameras_; ++c) {
      const CornerField& corners = corners_[v][static_cast<std::size_t>(c)];
      if (corners.empty()) continue;
      const Pose T_camera_board = sensor_board(state, c, v);
      cost += corners.cost({state.cameras[static_cast<std::size_t>(c)], T_camera_board, state.stretch},
                           corner_scale(c), input_.corner_huber);
    }
    for (int l = 0; l < lidars_; ++l) cost += lidar_cost(state, v, l, nullptr);
  }
  return cost + add_priors(state, nullptr);
}

std::optional<Eigen::VectorXd> JointProblem::step(double damping) {
  Eigen::MatrixXd S = prior_.H + total_.H;
  Eigen::VectorXd r = prior_.g + total_.g;
  S.diagonal() *= 1 + damping;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (!eliminated_[v].eliminate(views_[v], damping)) return std::nullopt;
    eliminated_[v].subtract_from(S, r);
  }
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(S);  // of its lower triangle
  if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return std::nullopt;
  Eigen::VectorXd step(globals_ + 6 * static_cast<Eigen::Index>(views_.size()));
  step.head(globals_) = -ldlt.solve(r);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    step.segment<6>(globals_ + 6 * static_cast<Eigen::Index>(v)) = eliminated_[v].step(step.head(globals_));
  }
  return step;
}

double JointProblem::predicted_decrease(const Eigen::VectorXd& step) const {
  const Eigen::VectorXd dg = step.head(globals_);
  double model = (prior_.g + total_.g).dot(dg) + 0.5 * dg.dot(prior_.H * dg) + 0.5 * dg.dot(total_.H * dg);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const Vector6d dv = step.segment<6>(globals_ + 6 * static_cast<Eigen::Index>(v));
    const ViewEquations& view = views_[v];
    Vector6d slope = view.gv + 0.5 * view.Hvv * dv;
    slope.noalias() += view.Hvg.lazyProduct(dg);
    model += slope.dot(dv);
  }
  return -model;
}

JointState JointProblem::moved(const State& state, const Eigen::VectorXd& step) const {
  State next = state;
  for (int c = 0; c < cameras_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (c > 0) next.T_ref_camera[i] = state.T_ref_camera[i].perturbed(step.segment<6>(camera_pose_index(c)));
    next.cameras[i].parameters.head(free_intrinsics(c)) +=
        step.segment(intrinsics_index(c), free_intrinsics(c));
  }
  if (stretch_free()) next.stretch += step.segment<2>(stretch_index());
  for (int l = 0; l < lidars_; ++l) {
    const auto i = static_cast<std::size_t>(l);
    next.T_ref_lidar[i] = state.T_ref_lidar[i].perturbed(step.segment<6>(lidar_pose_index(l)));
    next.range_bias[i] += step(bias_index(l));
    next.range_slope[i] += step(slope_index(l));
    next.dilation[i].angle += step(dilation_index(l));
    next.dilation[i].margin += step(dilation_index(l) + 1);
  }
  next.rim_depth += step(rim_depth_index());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    next.T_ref_board[v] =
        state.T_ref_board[v].perturbed(step.segment<6>(globals_ + 6 * static_cast<Eigen::Index>(v)));
  }
  return next;
}

Misfit JointProblem::misfit(const State& state, std::size_t view) {
  // A sensor's Newton decrement, twice, is what its own cost could still fall if it had the board pose to
  // itself. Summed over sensors whose gradients cancel this is their disagreement over its covariance.
  const auto decrement = [](const auto& H, const auto& g) { return g.dot(H.ldlt().solve(g)); };
  Misfit misfit;
  Matrix6d H_cameras = Matrix6d::Zero();
  Vector6d g_cameras = Vector6d::Zero();
  for (int c = 0; c < cameras_; ++c) {
    CornerField& corners = corners_[view][static_cast<std::size_t>(c)];
    if (corners.empty()) continue;
    const Camera& camera = state.cameras[static_cast<std::size_t>(c)];
    const Pose T_camera_board = sensor_board(state, c, view);
    const CornerModel model{camera, T_camera_board, state.stretch};
    if (!corners.approach(model, corner_scale(c), input_.corner_huber, input_.corner_reach)) {
      misfit.lidars = misfit.cameras = std::numeric_limits<double>::infinity();
      return misfit;
    }
    const CameraEquations sensor = corners.equations(model, corner_scale(c), input_.corner_huber);
    const Matrix6d H = sensor.H.topLeftCorner<6, 6>();
    const Vector6d g = sensor.g.head<6>();
    misfit.cameras += decrement(H, g);
    misfit.camera_freedom += 6;
    H_cameras += H;
    g_cameras += g;
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
    const Pose T_lidar_board = sensor_board(state, cameras_ + l, view);
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

void JointProblem::view_share(const State& state, std::size_t view, Eigen::MatrixXd& information,
                              Eigen::VectorXd& gradient) {
  DenseNormalEquations own;
  own.clear(globals_);
  linearize_view(state, view, own);
  Elimination eliminated;
  eliminated.eliminate(views_[view], 0);
  eliminated.subtract_from(own.H, own.g);
  information = std::move(own.H);
  gradient = std::move(own.g);
  information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
}

DenseNormalEquations JointProblem::marginal() const {
  DenseNormalEquations marginal{prior_.H + total_.H, prior_.g + total_.g};
  Elimination eliminated;
  for (const ViewEquations& view : views_) {
    eliminated.eliminate(view, 0);
    eliminated.subtract_from(marginal.H, marginal.g);
  }
  marginal.H.triangularView<Eigen::StrictlyUpper>() = marginal.H.transpose();
  return marginal;
}

Eigen::MatrixXd JointProblem::information() const {
  return marginal().H;
}

double JointProblem::lidar_place_sigma() const {
  const auto covariance = scaled_inverse(information());
  if (!covariance) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (int l = 0; l < lidars_; ++l) {
    const Eigen::Index i = lidar_pose_index(l) + 3;
    largest = std::max(largest, covariance->block<3, 3>(i, i).trace());
  }
  return std::sqrt(largest);
}

double JointProblem::range_rms(const State& state, std::size_t view) const {
  double weight = 0, squares = 0;
  for (int l = 0; l < lidars_; ++l) {
    const auto k = static_cast<std::size_t>(l);
    const std::optional<RangeSums>& sums = input_.views[view].ranges[k];
    if (!sums) continue;
    const Eigen::Vector3d q = inverse_plane(board_plane(sensor_board(state, cameras_ + l, view)));
    squares += 2 * std::max(0.0, sums->at(sums->z(q, state.range_bias[k], state.range_slope[k])));
    weight += sums->weight;
  }
  return weight > 0 ? std::sqrt(squares / weight) : 0;
}

JointState state_of_views(const JointState& all, std::span<const std::size_t> views) {
  JointState some = all;
  some.T_ref_board.clear();
  for (const std::size_t v : views) some.T_ref_board.push_back(all.T_ref_board[v]);
  return some;
}

void take_state_of_views(JointState& all, JointState some, std::span<const std::size_t> views) {
  std::vector<Pose> boards = std::move(all.T_ref_board);
  for (std::size_t i = 0; i < views.size(); ++i) boards[views[i]] = some.T_ref_board[i];
  all = std::move(some);
  all.T_ref_board = std::move(boards);
}

}  // namespace ca2
