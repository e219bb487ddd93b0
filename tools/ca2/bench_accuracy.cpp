/// `ca2 bench accuracy`: the estimator against truth, the published methods and the Cramer-Rao bound.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/geometry/scaled_inverse.h"
#include "core/solve/board_rays.h"
#include "core/solve/calibrate.h"
#include "core/solve/joint_problem.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_timing.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"

namespace ca2 {
namespace {

constexpr int pool_size = 80;
constexpr int trials = 30;

/// Errors of one method over the trials, m and rad.
struct Column {
  int answers = 0;
  double translation = 0, translation2 = 0, rotation = 0, rotation2 = 0, nees = 0;

  void add(const Result<Calibration>& answer, const Scenario& scenario) {
    if (!answer) return;
    const CalibratedTransform& first = answer->transforms.front();
    const TransformError e = error_of(first, true_transform(scenario, first.parent, first.child));
    ++answers;
    translation += e.translation;
    translation2 += e.translation * e.translation;
    rotation += e.rotation;
    rotation2 += e.rotation * e.rotation;
    nees += e.nees / 6;
  }
  nlohmann::json json() const {
    const double n = std::max(1, answers);
    return {{"answers", answers},
            {"translation_mean_mm", 1e3 * translation / n},
            {"translation_rms_mm", 1e3 * std::sqrt(translation2 / n)},
            {"rotation_mean_mrad", 1e3 * rotation / n},
            {"rotation_rms_mrad", 1e3 * std::sqrt(rotation2 / n)},
            {"nees_per_6", nees / n}};
  }
};

struct Bound {
  double translation2 = 0, rotation2 = 0;  // traces of the covariance
};

/// The Cramer-Rao bound of the first camera and LiDAR at the truth: noise-free corners and ranges of these
/// views, true noise levels, board poses free, intrinsics and range bias known only as well as the priors
/// say. Nothing where the views do not determine the answer.
std::optional<Bound> cramer_rao(const Scenario& scenario, const Rig& rig,
                                const std::vector<SimulatedView>& views) {
  JointInput input;
  JointState state;
  input.board_corners = rig.board.type->corners(rig.board);
  input.prior_bias = CalibrateOptions{}.prior_bias;
  const Pose T_rig_ref = scenario.T_rig_sensor(rig.cameras.begin()->first);
  for (const auto& [name, camera] : rig.cameras) {
    input.cameras.push_back(*camera.intrinsics);
    const CameraParameters& k = camera.intrinsics->parameters;
    const CalibrateOptions options;
    input.prior_intrinsics.emplace_back(options.prior_focal * k(0), options.prior_focal * k(1),
                                        options.prior_center, options.prior_center);
    state.T_ref_camera.push_back(T_rig_ref.inverse() * scenario.T_rig_sensor(name));
  }
  state.cameras = input.cameras;
  for (const auto& [name, lidar] : rig.lidars) {
    input.range_sigma.push_back(scenario.lidars.at(name).noise.range_sigma);
    state.T_ref_lidar.push_back(T_rig_ref.inverse() * scenario.T_rig_sensor(name));
    state.range_bias.push_back(0);
    state.range_slope.push_back(0);
    state.dilation.push_back(0);
    input.prior_range_slope.push_back(0);
  }
  for (const SimulatedView& view : views) {
    const auto& [sensor, T_sensor_board] = *view.T_sensor_board.begin();
    state.T_ref_board.push_back(T_rig_ref.inverse() * scenario.T_rig_sensor(sensor) * T_sensor_board);
    JointView& out = input.views.emplace_back();
    for (const auto& [name, camera] : rig.cameras) {
      std::vector<Corner>& corners = out.corners.emplace_back();
      if (const auto seen = view.corners.find(name); seen != view.corners.end()) corners = seen->second;
      for (Corner& corner : corners) {
        const Eigen::Vector2d& xy = input.board_corners[static_cast<std::size_t>(corner.id)];
        const auto pixel =
            camera.intrinsics->project(view.T_sensor_board.at(name) * Eigen::Vector3d(xy.x(), xy.y(), 0));
        if (pixel) corner.pixel = *pixel;
      }
    }
    out.edges.resize(rig.lidars.size());
    for (const auto& [name, lidar] : rig.lidars) {
      auto& sums = out.ranges.emplace_back();
      const auto rays = view.rays.find(name);
      if (rays == view.rays.end() || rays->second.empty()) continue;
      const Plane plane = board_plane(view.T_sensor_board.at(name));
      std::vector<BoardReturn> returns;
      for (const BeamRay& ray : rays->second) {
        const double range = -plane.distance(ray.origin) / plane.normal.dot(ray.direction);
        returns.push_back({(ray.origin + range * ray.direction).cast<float>()});
      }
      sums = range_sums(returns, inverse_plane(plane), 0, 0.1);
    }
  }
  JointProblem problem(input);
  problem.linearize(state);
  const auto covariance = scaled_inverse(problem.information());
  if (!covariance) return std::nullopt;
  const auto i = static_cast<Eigen::Index>(problem.lidar_pose_index(0));
  return Bound{covariance->block<3, 3>(i + 3, i + 3).trace(), covariance->block<3, 3>(i, i).trace()};
}

Result<nlohmann::json> accuracy_of(const ScenarioFile& file, int count, bool quiet) {
  const Result<std::vector<SimulatedView>> pool = simulate_pool(file.scenario, pool_size);
  if (!pool) return fail(pool.error());
  const Rig rig = rig_of(file.scenario);
  std::mt19937_64 rng(static_cast<std::uint64_t>(count));
  Column kim, planes, joint;
  double bound_t2 = 0, bound_r2 = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Rig stated = misstated_rig(rig, file.intrinsics_error, rng);
    const std::vector<SimulatedView> views = draw_subset(*pool, count, rng);
    Result<std::vector<ViewSights>> sights = sights_of(stated, views);
    if (!sights) return fail(sights.error());
    // The bound is that of planes and corners: the estimator gets no more.
    for (ViewSights& view : *sights) {
      for (auto& hypotheses : view.lidars) {
        for (LidarSight& sight : hypotheses) sight.crossings.clear();
      }
    }
    CalibrateOptions options;
    const auto answer = calibrate(stated, *sights, options);
    const auto bound = cramer_rao(file.scenario, rig, views);
    // Only subsets that determine the answer are compared, the same for all.
    if (!answer || !bound) continue;
    joint.add(answer, file.scenario);
    bound_t2 += bound->translation2;
    bound_r2 += bound->rotation2;
    options.method = Method::plane_to_plane;
    planes.add(calibrate(stated, *sights, options), file.scenario);
    options.method = Method::kim;
    kim.add(calibrate(stated, *sights, options), file.scenario);
  }
  const double n = std::max(1, joint.answers);
  const double bound_t = std::sqrt(bound_t2 / n), bound_r = std::sqrt(bound_r2 / n);
  nlohmann::json row{{"rig", file.scenario.name},
                     {"views", count},
                     {"trials", trials},
                     {"kim", kim.json()},
                     {"plane_to_plane", planes.json()},
                     {"joint", joint.json()},
                     {"bound_translation_mm", 1e3 * bound_t},
                     {"bound_rotation_mrad", 1e3 * bound_r}};
  const auto rms_t = [](const Column& c) { return 1e3 * std::sqrt(c.translation2 / std::max(1, c.answers)); };
  const auto rms_r = [](const Column& c) { return 1e3 * std::sqrt(c.rotation2 / std::max(1, c.answers)); };
  const auto mean_t = [](const Column& c) { return 1e3 * c.translation / std::max(1, c.answers); };
  if (!quiet) {
    std::printf(
        "%-15s %3d %3d | %6.2f %6.2f %6.2f | %6.2f %6.2f %6.2f %6.2f | %5.2f %5.2f %5.2f %5.2f | %5.2f %5.2f "
        "| %5.1f | %4.2f\n",
        file.scenario.name.c_str(), count, joint.answers, mean_t(kim), mean_t(planes), mean_t(joint),
        rms_t(kim), rms_t(planes), rms_t(joint), 1e3 * bound_t, rms_r(kim), rms_r(planes), rms_r(joint),
        1e3 * bound_r, rms_t(joint) / (1e3 * bound_t), rms_r(joint) / (1e3 * bound_r),
        mean_t(planes) / mean_t(joint), joint.nees / n);
    std::fflush(stdout);
  }
  return row;
}

/// CPU time of one whole calibration from extracted features, median of the repeats.
Result<nlohmann::json> time_of(const ScenarioFile& file, int count, int repeats, bool quiet) {
  const Result<std::vector<SimulatedView>> views = simulate_pool(file.scenario, count);
  if (!views) return fail(views.error());
  const Rig rig = rig_of(file.scenario);
  const Result<std::vector<ViewSights>> sights = sights_of(rig, *views);
  if (!sights) return fail(sights.error());
  std::vector<double> ms;
  for (int i = 0; i < repeats; ++i) {
    const double start = cpu_ms();
    const auto answer = calibrate(rig, *sights, {});
    ms.push_back(cpu_ms() - start);
    if (!answer) return fail(answer.error());
  }
  std::sort(ms.begin(), ms.end());
  const double median = ms[ms.size() / 2];
  if (!quiet)
    std::printf("%-15s %4d views  %8.1f ms  %.3f ms per view\n", file.scenario.name.c_str(), count, median,
                median / count);
  return nlohmann::json{{"rig", file.scenario.name}, {"views", count}, {"ms", median}};
}

}  // namespace

Result<int> bench_accuracy(const BenchOptions& options) {
  nlohmann::json rows = nlohmann::json::array(), times = nlohmann::json::array();
  if (!options.json) {
    std::printf(
        "Simulated features, board at random places; per cell %d random subsets of a pool of %d views, those "
        "that\n"
        "determine the answer (n); intrinsics and range biases wrong as the scenario says; corners off by "
        "0.05 px.\n"
        "bound: Cramer-Rao for planes and corners, with the priors of `joint`. NEES/6: 1 is a true "
        "covariance.\n\n"
        "%-15s %3s %3s | %-20s | %-27s | %-23s | %-11s | %5s | %s\n"
        "%-15s %3s %3s | %6s %6s %6s | %6s %6s %6s %6s | %5s %5s %5s %5s | %5s %5s | %5s |\n",
        trials, pool_size, "rig", "N", "n", "mean translation, mm", "rms translation, mm",
        "rms rotation, mrad", "joint/bound", "p2p/", "NEES", "", "", "", "kim", "p2p", "joint", "kim", "p2p",
        "joint", "bound", "kim", "p2p", "joint", "bound", "trans", "rot", "joint");
  }
  std::vector<ScenarioFile> files;
  for (const char* name : {"paper", "os0_t265", "os0_manta", "vlp16_blackfly"}) {
    // Of the source tree, unless said otherwise.
    const std::filesystem::path folder = options.data.empty() ? "config/scenarios" : options.data;
    Result<ScenarioFile> file = read_scenario(folder / (std::string(name) + ".yaml"));
    if (!file) return fail(file.error());
    files.push_back(*std::move(file));
  }
  for (const ScenarioFile& file : files) {
    for (const int count : {3, 5, 10, 20, 39}) {
      auto row = accuracy_of(file, count, options.json);
      if (!row) return fail(row.error());
      rows.push_back(*row);
    }
  }
  if (!options.json)
    std::printf("\nCPU time of one calibration, features extracted, one thread, median of %d\n",
                std::min(options.repeats, 5));
  for (const ScenarioFile& file : files) {
    for (const int count : {39, 100, 1000}) {
      auto time = time_of(file, count, std::min(options.repeats, 5), options.json);
      if (!time) return fail(time.error());
      times.push_back(*time);
    }
  }
  if (options.json) std::printf("%s\n", nlohmann::json{{"accuracy", rows}, {"times", times}}.dump(2).c_str());
  return 0;
}

}  // namespace ca2
