/// `ca2 bench stereo`: the published experiment on real data, which needs no truth about the LiDAR: two
/// cameras are calibrated to it apart, from random subsets of the views, and the baseline between them that
/// follows is compared with the known one.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/features/extract.h"
#include "core/types/text.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_scenarios.h"
#include "tools/ca2/bench_stereo_trials.h"
#include "tools/ca2/progress.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

constexpr int pool_size = 53;  // views of the published experiment, of which subsets are drawn
constexpr int view_counts[] = {3, 4, 5, 10, 20, 30, 39};

struct MeanAndDeviation {
  double mean = 0, deviation = 0;
};

MeanAndDeviation summary(const std::vector<double>& values) {
  if (values.empty()) return {};
  const double count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / std::max(1.0, count - 1))};
}

/// Every trial of a simulated rig has views, noise, biases and errors of the intrinsics of its own.
Result<StereoPool> simulate(const ScenarioFile& file, std::mt19937_64& rng) {
  Scenario scenario = file.scenario;
  scenario.seed = rng();
  const Result<std::vector<SimulatedView>> views = simulate_pool(scenario, pool_size);
  if (!views) return fail(views.error());
  StereoPool pool;
  pool.rig = misstated_rig(rig_of(scenario), file.intrinsics_error, rng);
  Result<std::vector<ViewSights>> sights = sights_of(pool.rig, *views);
  if (!sights) return fail(sights.error());
  pool.views = *std::move(sights);
  if (auto kept = keep_stereo(pool); !kept) return fail(kept.error());
  const auto& cameras = pool.rig.cameras;
  pool.T_left_right = true_transform(scenario, cameras.begin()->first, std::next(cameras.begin())->first);
  return pool;
}

/// The session's truth where it is simulated; else what its rig says; else nothing.
Result<std::optional<Pose>> stated_baseline(const Session& session, const std::string& left,
                                            const std::string& right, std::string& source) {
  std::map<std::string, Pose> to_left;  // T_left_x of what is tied to the left camera by one transform
  const auto tie = [&](const std::string& parent, const std::string& child, const Pose& T_parent_child) {
    if (parent == left) to_left.emplace(child, T_parent_child);
    if (child == left) to_left.emplace(parent, T_parent_child.inverse());
  };
  if (const auto file = session.directory / "truth.yaml"; std::filesystem::exists(file)) {
    const auto truth = read_true_transforms(file);
    if (!truth) return fail(truth.error());
    for (const TrueTransform& t : *truth) tie(t.parent, t.child, t.T_parent_child);
    for (const TrueTransform& t : *truth) {
      if (t.parent == right && to_left.contains(t.child))
        to_left.emplace(right, to_left.at(t.child) * t.T_parent_child.inverse());
    }
    source = "truth.yaml";
  } else {
    for (const RigExtrinsic& e : session.rig.extrinsics) tie(e.parent, e.child, e.T_parent_child);
    source = "session.yaml";
  }
  const auto known = to_left.find(right);
  if (known == to_left.end()) return std::nullopt;
  return known->second;
}

/// `source`: where the baseline is known from.
Result<StereoPool> read_pool(const std::filesystem::path& folder, std::string& source) {
  const Result<Session> session = open_session(folder);
  if (!session) return fail(session.error());
  Progress progress("finding the board");
  ExtractOptions extract;
  extract.progress = [&](int done, int total) { progress.show(done, total); };
  Result<Extraction> features = extract_features(*session, extract);
  if (!features) return fail(features.error());
  StereoPool pool{std::move(features->rig), std::move(features->views), std::move(features->estimated), {}};
  if (auto kept = keep_stereo(pool); !kept) return fail(kept.error());
  const auto& cameras = pool.rig.cameras;
  const auto known =
      stated_baseline(*session, cameras.begin()->first, std::next(cameras.begin())->first, source);
  if (!known) return fail(known.error());
  if (!*known) source = "all of these views at once";
  const Result<Pose> baseline = *known ? Result<Pose>(**known) : baseline_of_all(pool);
  if (!baseline) return fail(baseline.error());
  pool.T_left_right = *baseline;
  return pool;
}

void print_header() {
  std::printf(
      "Two cameras calibrated to one LiDAR, each alone, from N views drawn at random; the baseline that "
      "follows against\nthe known one: mean (standard deviation) of the sizes of its errors over n subsets. "
      "`all at once`: both cameras and the\nLiDAR in one solve. What is wrong with the LiDAR alike for both "
      "cameras, as a bias of its ranges, does not show here.\n\n%-12s %3s %4s      ",
      "", "N", "n");
  for (const char* method : stereo_methods) std::printf(" %18s", method);
  std::printf("\n");
}

void print_cell(const std::string& name, const StereoCell& cell) {
  const auto row = [&](const char* unit, std::vector<double> StereoErrors::*errors) {
    std::printf(" %-5s", unit);
    for (const StereoErrors& of_method : cell.errors) {
      const auto [mean, deviation] = summary(of_method.*errors);
      std::printf(" %18s", formatted("%.3f (%.3f)", 1e3 * mean, 1e3 * deviation).c_str());
    }
    std::printf("\n");
  };
  std::printf("%-12s %3d %4d", name.c_str(), cell.views, cell.subsets);
  row("mm", &StereoErrors::translation);
  std::printf("%-12s %3s %4s", "", "", "");
  row("mrad", &StereoErrors::rotation);
  std::fflush(stdout);
}

nlohmann::json json_of(const std::string& name, const StereoCell& cell) {
  nlohmann::json row{{"rig", name}, {"views", cell.views}, {"subsets", cell.subsets}};
  for (std::size_t m = 0; m < stereo_methods.size(); ++m) {
    const auto translation = summary(cell.errors[m].translation), rotation = summary(cell.errors[m].rotation);
    row["methods"][stereo_methods[m]] = {{"translation_mean_mm", 1e3 * translation.mean},
                                         {"translation_deviation_mm", 1e3 * translation.deviation},
                                         {"rotation_mean_mrad", 1e3 * rotation.mean},
                                         {"rotation_deviation_mrad", 1e3 * rotation.deviation}};
  }
  return row;
}

/// All numbers of views, `trials` subsets of each. `draw` gives the views of a trial.
Result<std::vector<StereoCell>> run(const std::string& name, int trials, std::mt19937_64& rng,
                                    const std::function<Result<StereoPool>()>& draw) {
  std::vector<StereoCell> cells;
  for (const int count : view_counts) cells.emplace_back().views = count;
  Progress progress(name);
  for (int trial = 0; trial < trials; ++trial) {
    const Result<StereoPool> pool = draw();
    if (!pool) return fail(pool.error());
    for (StereoCell& cell : cells) {
      if (cell.views <= static_cast<int>(pool->views.size())) try_subset(*pool, rng, cell);
    }
    progress.show(trial + 1, trials);
  }
  return cells;
}

}  // namespace

Result<int> bench_stereo(const BenchOptions& options) {
  const int trials = options.trials > 0 ? options.trials : options.full ? 100 : 12;
  nlohmann::json rows = nlohmann::json::array();
  const auto tell = [&](const std::string& name, const std::vector<StereoCell>& cells) {
    for (const StereoCell& cell : cells) {
      if (cell.subsets == 0) continue;
      if (!options.json) print_cell(name, cell);
      rows.push_back(json_of(name, cell));
    }
  };
  std::mt19937_64 rng(options.seed);
  if (std::filesystem::exists(options.data / "session.yaml")) {
    std::string source;
    const Result<StereoPool> pool = read_pool(options.data, source);
    if (!pool) return fail(pool.error());
    if (!options.json) print_header();
    const std::string name = std::filesystem::weakly_canonical(options.data).filename().string();
    const auto cells = run(name, trials, rng, [&] { return *pool; });
    if (!cells) return fail(cells.error());
    tell(name, *cells);
    if (!options.json) {
      std::printf("\n%zu views in which all see the board; the baseline is known from %s: %.3f mm\n",
                  pool->views.size(), source.c_str(), 1e3 * pool->T_left_right.t.norm());
    }
  } else {
    const auto files = bench_scenarios(options.data, {"os0_t265", "os0_manta"}, options.only);
    if (!files) return fail(files.error());
    if (!options.json) print_header();
    for (const ScenarioFile& file : *files) {
      const std::string& name = file.scenario.name;
      // The same draws whatever else is run beside it.
      rng.seed(options.seed);
      const auto cells = run(name, trials, rng, [&] { return simulate(file, rng); });
      if (!cells) return fail(cells.error());
      tell(name, *cells);
    }
  }
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
