// A whole calibration: ours, and Ceres on all points, on the same features in one run.
// Optional (CA2_BENCH_CERES): `ca2` must not link Ceres.
//   ceres_solve config/scenarios/vlp16_blackfly.yaml
// Ceres gets what is hard about the problem for free: the pairs of board and returns that belong together,
// the noise levels, and a start one degree and 2 cm off. It solves once, and gives the extrinsic's
// covariance. Ours begins with nothing, finds all that, solves as often as it takes and leaves every view out
// once.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cmath>
#include <cstdio>

#include "core/solve/calibrate.h"
#include "tools/ca2/bench_timing.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"

namespace {

using namespace ca2;

constexpr double corner_sigma = 0.05;  // px
constexpr std::size_t most_returns = 2000;

/// A pose as angle axis and translation.
struct Block {
  double x[6];

  explicit Block(const Pose& pose) {
    const Eigen::Vector3d turn = so3_log(pose.R);
    for (int k = 0; k < 3; ++k) {
      x[k] = turn(k);
      x[3 + k] = pose.t(k);
    }
  }
  Pose pose() const {
    return {so3_exp(Eigen::Vector3d(x[0], x[1], x[2])), Eigen::Vector3d(x[3], x[4], x[5])};
  }
};

struct CornerResidual {
  Eigen::Vector2d place, pixel;
  CameraParameters shape;

  template <class T>
  bool operator()(const T* T_camera_board, const T* focal, T* residual) const {
    const T on_board[3] = {T(place.x()), T(place.y()), T(0)};
    T p[3];
    ceres::AngleAxisRotatePoint(T_camera_board, on_board, p);
    for (int k = 0; k < 3; ++k) p[k] += T_camera_board[3 + k];
    const T x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y;
    const T radial = 1.0 + r2 * (shape[4] + r2 * (shape[5] + r2 * (shape.size() > 8 ? shape[8] : 0.0)));
    const T u = x * radial + 2.0 * shape[6] * x * y + shape[7] * (r2 + 2.0 * x * x);
    const T v = y * radial + shape[6] * (r2 + 2.0 * y * y) + 2.0 * shape[7] * x * y;
    residual[0] = (focal[0] * u + focal[2] - pixel.x()) / corner_sigma;
    residual[1] = (focal[1] * v + focal[3] - pixel.y()) / corner_sigma;
    return true;
  }
};

/// Range along the ray to the board's plane.
struct RangeResidual {
  Eigen::Vector3d ray;
  double range, sigma;

  template <class T>
  bool operator()(const T* T_camera_board, const T* T_lidar_camera, const T* bias, T* residual) const {
    const T axis[3] = {T(0), T(0), T(1)};
    T in_camera[3], normal[3], origin[3];
    ceres::AngleAxisRotatePoint(T_camera_board, axis, in_camera);
    ceres::AngleAxisRotatePoint(T_lidar_camera, in_camera, normal);
    ceres::AngleAxisRotatePoint(T_lidar_camera, T_camera_board + 3, origin);
    T distance(0), along(0);
    for (int k = 0; k < 3; ++k) {
      distance += normal[k] * (origin[k] + T_lidar_camera[3 + k]);
      along += normal[k] * ray[k];
    }
    residual[0] = (range - bias[0] - distance / along) / sigma;
    return true;
  }
};

struct PriorResidual {
  double mean[4], sigma[4];

  template <class T>
  bool operator()(const T* x, T* residual) const {
    for (int k = 0; k < 4; ++k) residual[k] = (x[k] - mean[k]) / sigma[k];
    return true;
  }
};

struct BiasResidual {
  template <class T>
  bool operator()(const T* x, T* residual) const {
    residual[0] = x[0] / CalibrateOptions{}.prior_bias;
    return true;
  }
};

struct Answer {
  double ms = 0;
  Pose T_camera_lidar;
  double sigma = 0;  ///< of the translation, m
  int iterations = 0;
};

Answer solve_with_ceres(const Rig& rig, const std::vector<ViewSights>& views, const Pose& start,
                        double range_sigma) {
  const std::vector<Eigen::Vector2d> places = rig.board.type->corners(rig.board);
  const Camera& camera = *rig.cameras.begin()->second.intrinsics;
  const double begin = cpu_ms();
  Block T_lidar_camera(start.inverse());
  double focal[4], bias[1] = {0};
  PriorResidual prior{};
  for (int k = 0; k < 4; ++k) {
    focal[k] = prior.mean[k] = camera.parameters(k);
    prior.sigma[k] = k < 2 ? CalibrateOptions{}.prior_focal * focal[k] : CalibrateOptions{}.prior_center;
  }
  std::vector<Block> boards;
  for (const ViewSights& view : views) {
    boards.emplace_back(view.cameras[0] ? view.cameras[0]->pose.T_camera_board : Pose{});
  }
  ceres::Problem problem;
  auto order = std::make_shared<ceres::ParameterBlockOrdering>();
  ceres::LossFunction* huber = new ceres::HuberLoss(3);
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!views[v].cameras[0] || views[v].lidars[0].empty()) continue;
    for (const Corner& corner : views[v].cameras[0]->corners) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<CornerResidual, 2, 6, 4>(new CornerResidual{
              places[static_cast<std::size_t>(corner.id)], corner.pixel, camera.parameters}),
          huber, boards[v].x, focal);
    }
    for (const BoardReturn& here : views[v].lidars[0][0].on_board) {
      const Eigen::Vector3d p = here.point.cast<double>();
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<RangeResidual, 1, 6, 6, 1>(
                                   new RangeResidual{p.normalized(), p.norm(), range_sigma}),
                               nullptr, boards[v].x, T_lidar_camera.x, bias);
    }
    order->AddElementToGroup(boards[v].x, 0);
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual, 4, 4>(new PriorResidual(prior)),
                           nullptr, focal);
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<BiasResidual, 1, 1>(new BiasResidual), nullptr,
                           bias);
  for (double* block : {T_lidar_camera.x, focal, bias}) order->AddElementToGroup(block, 1);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering = order;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ceres::Covariance::Options how;
  how.algorithm_type = ceres::SPARSE_QR;
  how.num_threads = 1;
  ceres::Covariance covariance(how);
  Answer answer;
  if (covariance.Compute(std::vector<const double*>{T_lidar_camera.x}, &problem)) {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> C;
    covariance.GetCovarianceBlock(T_lidar_camera.x, T_lidar_camera.x, C.data());
    answer.sigma = std::sqrt(C.bottomRightCorner<3, 3>().trace());
  }
  answer.ms = cpu_ms() - begin;
  answer.T_camera_lidar = T_lidar_camera.pose().inverse();
  answer.iterations = static_cast<int>(summary.iterations.size());
  return answer;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(
        stderr,
        "usage: ceres_solve SCENARIO.yaml [PAIRS]: a rig of one pinhole_radtan camera and one LiDAR\n");
    return 64;
  }
  const auto file = read_scenario(argv[1]);
  if (!file || file->scenario.cameras.size() != 1 || file->scenario.lidars.size() != 1) {
    std::fprintf(stderr, "%s: no scenario of one camera and one LiDAR\n", argv[1]);
    return 65;
  }
  const int pairs = argc > 2 ? std::atoi(argv[2]) : 9;
  const Rig rig = rig_of(file->scenario);
  const Pose truth = true_transform(file->scenario, rig.cameras.begin()->first, rig.lidars.begin()->first);
  Vector6d off;
  off << 0.01, -0.01, 0.01, 0.012, -0.012, 0.012;
  std::printf("%s: planes and corners, at most %zu returns per view; CPU time of one thread, medians of %d\n",
              file->scenario.name.c_str(), most_returns, pairs);
  std::printf("%5s %9s | %10s %10s | %6s | %s\n", "views", "returns", "ours ms", "Ceres ms", "ratio",
              "error and sigma, mm: ours, Ceres");
  for (const int count : {10, 39, 100, 1000}) {
    const auto views = simulate_pool(file->scenario, count);
    auto sights = sights_of(rig, *views);
    if (!sights) return 70;
    std::size_t returns = 0;
    for (ViewSights& view : *sights) {
      for (LidarSight& sight : view.lidars[0]) {
        sight.crossings.clear();
        if (sight.on_board.size() > most_returns) sight.on_board.resize(most_returns);
        returns += sight.on_board.size();
      }
    }
    std::vector<double> ours, theirs, ratios;
    Answer ceres;
    Result<Calibration> answer = calibrate(rig, *sights, {});
    const double sigma = file->scenario.lidars.begin()->second.noise.range_sigma;
    for (int pair = 0; pair < (count < 1000 ? pairs : std::min(pairs, 3)); ++pair) {
      const double start = cpu_ms();
      answer = calibrate(rig, *sights, {});
      ours.push_back(cpu_ms() - start);
      ceres = solve_with_ceres(rig, *sights, truth.perturbed(off), sigma);
      theirs.push_back(ceres.ms);
      ratios.push_back(ours.back() / theirs.back());
    }
    if (!answer) return 1;
    const CalibratedTransform& found = answer->transforms.front();
    std::printf("%5d %9zu | %10.2f %10.2f | %6.4f | %.3f %.3f, %.3f %.3f (%d iterations)\n", count, returns,
                median(ours), median(theirs), median(ratios), 1e3 * (found.T_parent_child.t - truth.t).norm(),
                1e3 * found.sigma_translation(), 1e3 * (ceres.T_camera_lidar.t - truth.t).norm(),
                1e3 * ceres.sigma, ceres.iterations);
    std::fflush(stdout);
  }
  return 0;
}
