/// `ca2 bench accuracy`: the estimator against truth, the published methods and the Cramer-Rao bound.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_accuracy_plot.h"
#include "tools/ca2/bench_accuracy_times.h"
#include "tools/ca2/bench_accuracy_trials.h"
#include "tools/ca2/bench_scenarios.h"
#include "tools/ca2/progress.h"

namespace ca2 {
namespace {

/// What refinement leaves of a corner's error in pictures with this noise: 0.010 px at 0.007 (refine_test).
double corner_sigma(double picture_sigma) {
  return 0.010 * picture_sigma / 0.007;
}

/// Pictures refined as well as ours are, and nothing that the published experiment did not have.
void make_plain(Scenario& scenario) {
  for (auto& [name, camera] : scenario.cameras) camera.noise.corner_sigma = corner_sigma(camera.noise.sigma);
  for (auto& [name, lidar] : scenario.lidars) lidar.noise.range_bias = lidar.noise.reflectivity_bias = 0;
}

/// The published experiment: 53 views, subsets of them, three levels of noise on ranges and pictures. Its
/// intrinsics and ranges are right; one run has the intrinsics off, two are told that nothing is.
std::vector<AccuracyExperiment> paper_experiments(const ScenarioFile& paper, bool full) {
  std::vector<AccuracyExperiment> list;
  for (const auto& [name, range, picture] :
       {std::tuple{"paper 0 mm", 0.0, 0.0}, {"paper 8 mm", 0.008, 0.007}, {"paper 16 mm", 0.016, 0.014}}) {
    AccuracyExperiment experiment{name, paper, 0, 0, 53, {3, 4, 5, 10, 20, 30, 39, 40}};
    if (!full) experiment.view_counts = {3, 5, 10, 20, 39};
    experiment.file.intrinsics_error = {};
    for (auto& [camera_name, camera] : experiment.file.scenario.cameras) camera.noise.sigma = picture;
    make_plain(experiment.file.scenario);
    for (auto& [lidar_name, lidar] : experiment.file.scenario.lidars) {
      lidar.noise.range_sigma = range;
      if (range == 0) lidar.noise.dropout = lidar.beams.range_quantum = 0;
    }
    list.push_back(experiment);
  }
  AccuracyExperiment off = list[1];
  off.name = "paper 8 mm, K off";
  off.file.intrinsics_error = {.pixel = 1, .focal = 0.003};
  off.view_counts = {10, 39};
  list.push_back(off);
  for (const std::size_t noisy : {1, 2}) {
    AccuracyExperiment held = list[noisy];
    held.name += ", held";
    held.held = {.intrinsics = true, .ranges = true};
    list.push_back(held);
  }
  return list;
}

/// A rig with an A3 board and a range bias of 10 to 15 mm; `all`: and with intrinsics off and ranges that
/// depend on the print's brightness, as its scenario says.
AccuracyExperiment a3_experiment(const ScenarioFile& file, bool all, bool full) {
  AccuracyExperiment experiment{
      file.scenario.name + (all ? ", all" : ""), file, 0.010, 0.015, 53, {3, 5, 10, 17, 39}};
  if (!full) experiment.view_counts = {5, 17, 39};
  if (all && !full) experiment.view_counts = {17};
  make_plain(experiment.file.scenario);
  if (!all) experiment.file.intrinsics_error = {};
  for (auto& [name, lidar] : experiment.file.scenario.lidars)
    lidar.noise.reflectivity_bias = all ? file.scenario.lidars.at(name).noise.reflectivity_bias : 0;
  return experiment;
}

void print_header(int trials) {
  std::printf(
      "Simulated features. Per cell %d trials: each with 53 views at random places, biases and errors of its "
      "own,\nof which N are drawn; those that planes alone determine (n). Means of translation errors, mm; "
      "bounds: the root\nmean trace; ratios: rms(error / bound) of translation and rotation; NEES / 6: 1 is "
      "an honest covariance; 95 %%: truths\nwithin that ellipsoid; gain: plane_to_plane over joint with "
      "edges.\n\n"
      "%-19s %3s %3s | %6s %6s | %-31s | %-31s | %5s\n"
      "%-19s %3s %3s | %6s %6s | %6s %6s %5s %5s %5s | %6s %6s %5s %5s %5s %4s | %5s\n",
      trials, "", "", "", "", "", "joint: planes", "joint with edges", "", "experiment", "N", "n", "kim",
      "p2p", "mean", "bound", "trans", "rot", "NEES", "mean", "bound", "trans", "rot", "NEES", "95 %",
      "gain");
}

void print_row(AccuracyCell& cell) {
  const MethodErrors &kim = cell.methods[kim_name], &planes = cell.methods[planes_name];
  const MethodErrors &joint = cell.methods[joint_name], &edges = cell.methods[edges_name];
  std::printf(
      "%-19s %3d %3d | %6.2f %6.2f | %6.3f %6.3f %5.2f %5.2f %5.2f | %6.3f %6.3f %5.2f %5.2f %5.2f %4.0f | "
      "%5.1f\n",
      cell.experiment.c_str(), cell.views, cell.trials, 1e3 * kim.mean_translation(),
      1e3 * planes.mean_translation(), 1e3 * joint.mean_translation(), 1e3 * cell.bound_translation,
      joint.ratio_translation(), joint.ratio_rotation(), joint.mean_nees(), 1e3 * edges.mean_translation(),
      1e3 * cell.edge_bound_translation, edges.ratio_translation(), edges.ratio_rotation(), edges.mean_nees(),
      100.0 * edges.covered / std::max(1, edges.answers),
      planes.mean_translation() / edges.mean_translation());
}

}  // namespace

Result<int> bench_accuracy(const BenchOptions& options) {
  const Result<std::vector<ScenarioFile>> files =
      bench_scenarios(options.data, {"paper", "os0_t265", "os0_manta", "vlp16_blackfly_a3"});
  if (!files) return fail(files.error());
  std::vector<AccuracyExperiment> experiments = paper_experiments(files->front(), options.full);
  for (const bool all : {false, true}) {
    for (std::size_t i = 1; i < files->size(); ++i)
      experiments.push_back(a3_experiment((*files)[i], all, options.full));
  }
  const int trials = options.trials > 0 ? options.trials : options.full ? 100 : 12;
  if (!options.json) print_header(trials);
  std::vector<AccuracyCell> all;
  for (const AccuracyExperiment& experiment : experiments) {
    if (experiment.name.find(options.only) == std::string::npos) continue;
    Progress progress(experiment.name);
    Result<std::vector<AccuracyCell>> cells =
        run_accuracy(experiment, trials, options.seed, [&](int done) { progress.show(done, trials); });
    if (!cells) return fail(cells.error());
    for (AccuracyCell& cell : *cells) {
      if (!options.json) print_row(cell);
      all.push_back(std::move(cell));
    }
    std::fflush(stdout);
  }
  if (!options.plot.empty()) {
    if (auto written = write_atomically(options.plot, accuracy_plot(all)); !written)
      return fail(written.error());
  }
  nlohmann::json rows = nlohmann::json::array(), times = nlohmann::json::array();
  for (const AccuracyCell& cell : all) rows.push_back(cell.json());
  const int repeats = std::min(options.repeats, 5);
  if (!options.json && options.only.empty())
    std::printf("\nCPU time of one calibration, features extracted, one thread, median of %d\n", repeats);
  for (const ScenarioFile& file : *files) {
    if (!options.only.empty()) break;
    for (const int count : {39, 100, 1000}) {
      if (count == 1000 && !options.full) continue;
      auto time = calibration_time(file, count, repeats, options.json);
      if (!time) return fail(time.error());
      times.push_back(*time);
    }
  }
  if (options.json) std::printf("%s\n", nlohmann::json{{"accuracy", rows}, {"times", times}}.dump(2).c_str());
  return 0;
}

}  // namespace ca2
