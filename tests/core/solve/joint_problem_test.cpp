/// The normal equations against numeric differentiation of the very cost, for a rig of two cameras and two
/// LiDARs with every kind of residual; and the elimination of the board poses against a dense solution.
#include "core/solve/joint_problem.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

namespace ca2 {
namespace {

struct Example {
  JointInput input;
  JointState state;

  Example() {
    std::mt19937_64 rng(3);
    std::normal_distribution<double> normal;
    const auto small = [&](double rotation, double translation) {
      Vector6d d;
      for (int k = 0; k < 6; ++k) d(k) = (k < 3 ? rotation : translation) * normal(rng);
      return d;
    };
    Camera camera{find_camera_model("pinhole_radtan"), {}, 1000, 800};
    camera.parameters.resize(8);
    camera.parameters << 800, 805, 500, 400, -0.1, 0.05, 0.001, -0.001;
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 4; ++x) input.board_corners.emplace_back(0.1 * x - 0.15, 0.1 * y - 0.1);
    }
    input.cameras = {camera, camera};
    input.range_sigma = {0.01, 0.02};
    // The second camera's distortion and the print are unknown too.
    CameraParameters all(8);
    all << 3, 3, 2, 2, 0.01, 0.02, 0.001, 0.001;
    input.prior_intrinsics = {Eigen::Vector4d(2, 2, 1, 1), all};
    input.prior_stretch = 0.003;
    input.prior_bias = 0.01;
    input.prior_dilation = 0.004;
    input.rim_freedom = {0.005, 0.01};
    input.edge_sway = {0, 0};
    input.prior_range_slope = {0.02, 0.01};
    Pose T_camera_lidar;
    T_camera_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    state.T_ref_camera = {Pose{}, Pose{}.perturbed(small(0.05, 0.2))};
    state.T_ref_lidar = {T_camera_lidar.perturbed(small(0.1, 0.1)),
                         T_camera_lidar.perturbed(small(0.1, 0.1))};
    state.cameras = input.cameras;
    state.cameras[0].parameters(0) += 1.5;
    state.cameras[1].parameters(3) -= 0.7;
    state.cameras[1].parameters(4) += 0.004;
    state.stretch = {0.002, -0.001};
    state.range_bias = {0.004, -0.007};
    state.range_slope = {0.003, -0.002};
    state.dilation = {{0.001, 0.003}, {0.002, -0.001}};
    state.rim_depth = 0.004;
    for (int v = 0; v < 3; ++v) {
      Pose T_ref_board = Pose{Eigen::Matrix3d::Identity(), {0.1 * v, 0.05, 2}}.perturbed(small(0.3, 0.05));
      state.T_ref_board.push_back(T_ref_board);
      JointView& view = input.views.emplace_back();
      view.ranges.resize(2);
      view.edges.resize(2);
      for (std::size_t s = 0; s < 2; ++s) {
        auto& corners = view.corners.emplace_back();
        for (int id = 0; id < 12; ++id) {
          const Eigen::Vector2d& xy = input.board_corners[static_cast<std::size_t>(id)];
          const auto pixel = state.cameras[s].project(state.T_ref_camera[s].inverse() *
                                                      (T_ref_board * Eigen::Vector3d(xy.x(), xy.y(), 0)));
          Eigen::Matrix2d covariance;
          covariance << 0.04, 0.01, 0.01, 0.09;
          corners.push_back({id, *pixel + 0.1 * Eigen::Vector2d(normal(rng), normal(rng)), covariance});
        }
        const Pose T_lidar_board = state.T_ref_lidar[s].inverse() * T_ref_board;
        std::vector<BoardReturn> returns;
        for (int i = 0; i < 60; ++i) {
          const Eigen::Vector3d p = T_lidar_board * Eigen::Vector3d(0.15 * normal(rng), 0.1 * normal(rng), 0);
          returns.push_back({((1 + 0.004 * normal(rng)) * p).cast<float>()});
        }
        view.ranges[s] = range_sums(returns, inverse_plane(board_plane(T_lidar_board)), 0, 1);
        std::vector<EdgeCrossing> crossings;
        for (int i = 0; i < 40; ++i) {
          // Across the upright sides, with gaps of 6 mm.
          const double x = (i % 2 ? 0.25 : -0.25) + 0.002 * normal(rng), y = 0.16 * (i / 40.0 - 0.5);
          const double out = i % 2 ? 0.003 : -0.003;
          const auto ray = [&](double at) {
            return Eigen::Vector3f((T_lidar_board * Eigen::Vector3d(at, y, 0)).normalized().cast<float>());
          };
          crossings.push_back({ray(x - out), ray(x + out), 1, static_cast<std::uint16_t>(i), false});
        }
        view.edges[s] = edge_sums(crossings, {0.5, 0.4, Eigen::Vector2d::Zero()}, T_lidar_board, {},
                                  {1e-4, 1e-3, 0}, 0.02);
      }
    }
    input.relative.push_back(
        {1, 3, (state.T_ref_camera[1].inverse() * state.T_ref_lidar[1]).perturbed(small(0.01, 0.01)),
         1e3 * Matrix6d::Identity()});
  }
};

/// Gradient of the cost by all unknowns, numerically.
Eigen::VectorXd numeric_gradient(const JointProblem& problem, const JointState& state, Eigen::Index size) {
  Eigen::VectorXd gradient(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const double h = 1e-6;
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(size, k);
    gradient(k) =
        (problem.cost(problem.moved(state, step)) - problem.cost(problem.moved(state, -step))) / (2 * h);
  }
  return gradient;
}

TEST(JointProblem, GradientIsThatOfTheCost) {
  const Example example;
  JointProblem problem(example.input);
  EXPECT_DOUBLE_EQ(problem.linearize(example.state), problem.cost(example.state));
  const Eigen::Index size = problem.globals() + 18;
  const Eigen::VectorXd numeric = numeric_gradient(problem, example.state, size);
  // predicted_decrease(s) = -g.s - 1/2 s'Hs: its odd part is the gradient.
  for (Eigen::Index k = 0; k < size; ++k) {
    const Eigen::VectorXd unit = 1e-3 * Eigen::VectorXd::Unit(size, k);
    const double analytic = -(problem.predicted_decrease(unit) - problem.predicted_decrease(-unit)) / 2e-3;
    EXPECT_NEAR(analytic, numeric(k), 1e-5 * (1 + std::abs(numeric(k))) + 1e-4) << "unknown " << k;
  }
}

TEST(JointProblem, EliminationGivesTheStepOfTheWholeSystem) {
  const Example example;
  JointProblem problem(example.input);
  problem.linearize(example.state);
  const Eigen::Index size = problem.globals() + 18;
  Eigen::VectorXd g(size);
  Eigen::MatrixXd H(size, size);
  const auto model = [&](const Eigen::VectorXd& s) { return -problem.predicted_decrease(s); };
  for (Eigen::Index i = 0; i < size; ++i) {
    const Eigen::VectorXd a = Eigen::VectorXd::Unit(size, i);
    g(i) = 0.5 * (model(a) - model(-a));
    for (Eigen::Index k = 0; k < size; ++k) {
      const Eigen::VectorXd b = Eigen::VectorXd::Unit(size, k);
      H(i, k) = 0.25 * (model(a + b) - model(a - b) - model(b - a) + model(-a - b));
    }
  }
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scale.asDiagonal() * H * scale.asDiagonal());
  const Eigen::VectorXd scaled_g = scale.cwiseProduct(g);
  const Eigen::VectorXd dense = -scale.cwiseProduct(Eigen::VectorXd(ldlt.solve(scaled_g)));
  const auto step = problem.step(0);
  ASSERT_TRUE(step);
  for (Eigen::Index k = 0; k < size; ++k)
    EXPECT_NEAR((*step)(k), dense(k), 1e-6 * (scale(k) + std::abs(dense(k)))) << k;
  // The information of the globals is the inverse of their block of the whole covariance.
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() * ldlt.solve(Eigen::MatrixXd::Identity(size, size)) * scale.asDiagonal();
  const Eigen::MatrixXd product =
      covariance.topLeftCorner(problem.globals(), problem.globals()) * problem.information();
  const Eigen::VectorXd s = scale.head(problem.globals());
  const Eigen::MatrixXd scaled = s.cwiseInverse().asDiagonal() * product * s.asDiagonal();
  EXPECT_LT((scaled - Eigen::MatrixXd::Identity(problem.globals(), problem.globals())).norm(), 1e-4);
}

TEST(JointProblem, ACornerThatIsNoNumberLeavesNothingDetermined) {
  Example example;
  example.input.stated = {true, true};
  example.input.views[1].corners[0][3].covariance << -1, 0, 0, -1;
  JointProblem problem(example.input);
  problem.linearize(example.state);
  EXPECT_FALSE(problem.step(0));
  EXPECT_FALSE(problem.information().allFinite());
  EXPECT_FALSE(problem.nuisance_evidence(example.state, Priors::doubted));
  EXPECT_EQ(problem.lidar_place_sigma(), std::numeric_limits<double>::infinity());
}

TEST(JointProblem, MisfitTellsWhoDisagrees) {
  Example example;
  example.input.relative.clear();
  const Misfit before = JointProblem(example.input).misfit(example.state, 0);
  EXPECT_EQ(before.lidar_freedom, 6);
  EXPECT_EQ(before.camera_freedom, 6);
  // A LiDAR's plane moves by ten sigma: only the LiDARs disagree more.
  example.input.views[0].ranges[0]->gradient.head<3>() +=
      example.input.views[0].ranges[0]->H.topLeftCorner<3, 3>() * Eigen::Vector3d(0.01, 0, 0);
  const Misfit after = JointProblem(example.input).misfit(example.state, 0);
  EXPECT_GT(after.lidars, before.lidars + 10);
  EXPECT_NEAR(after.cameras, before.cameras, 1e-9 * before.cameras);
}

}  // namespace
}  // namespace ca2
