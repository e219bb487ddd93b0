/// `ca2 bench solve`: the CPU time of whole calibrations with covariance, features extracted, by the number
/// of views.
#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "core/solve/calibrate.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_scenarios.h"
#include "tools/ca2/bench_timing.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"

namespace ca2 {
namespace {

constexpr int counts[] = {10, 39, 100, 1000};

std::size_t returns_of(const std::vector<ViewSights>& views) {
  std::size_t sum = 0;
  for (const ViewSights& view : views) {
    for (const auto& hypotheses : view.lidars) {
      for (const LidarSight& sight : hypotheses) sum += sight.on_board.size() + sight.around.size();
    }
  }
  return sum;
}

/// ms of one whole calibration.
Result<double> time_once(const Rig& rig, const std::vector<ViewSights>& views) {
  const double start = cpu_ms();
  const auto answer = calibrate(rig, views, {});
  const double ms = cpu_ms() - start;
  if (!answer) return fail(answer.error());
  return ms;
}

Result<nlohmann::json> measure(const ScenarioFile& file, const BenchOptions& options) {
  const Result<std::vector<SimulatedView>> pool =
      simulate_pool(file.scenario, *std::max_element(std::begin(counts), std::end(counts)));
  if (!pool) return fail(pool.error());
  const Rig rig = rig_of(file.scenario);
  const Result<std::vector<ViewSights>> all = sights_of(rig, *pool);
  if (!all) return fail(all.error());
  nlohmann::json rows = nlohmann::json::array();
  std::map<int, double> with_rims, planes;
  for (const int count : counts) {
    const std::vector<ViewSights> views(all->begin(), all->begin() + count);
    const std::vector<ViewSights> bare = without_crossings(views);
    std::vector<double> ms[2];
    // The large ones take long enough to be measured well in a few repeats.
    for (int repeat = 0; repeat < (count < 1000 ? options.repeats : std::min(options.repeats, 5)); ++repeat) {
      for (const bool rims : {true, false}) {
        const Result<double> once = time_once(rig, rims ? views : bare);
        if (!once) return fail(once.error());
        ms[rims ? 1 : 0].push_back(*once);
      }
    }
    with_rims[count] = median(ms[1]);
    planes[count] = median(ms[0]);
    const double returns = static_cast<double>(returns_of(views)) / count;
    rows.push_back({{"rig", file.scenario.name},
                    {"views", count},
                    {"returns_per_view", returns},
                    {"rims_ms", with_rims[count]},
                    {"planes_ms", planes[count]}});
    if (options.json) continue;
    std::printf("%-18s %5d %8.0f | %9.2f %9.2f | %9.3f\n", file.scenario.name.c_str(), count, returns,
                planes[count], with_rims[count], with_rims[count] / count);
    std::fflush(stdout);
  }
  if (!options.json) {
    std::printf("%-18s time(1000) / time(100): planes %.1f, with rims %.1f\n", "", planes[1000] / planes[100],
                with_rims[1000] / with_rims[100]);
  }
  return rows;
}

}  // namespace

Result<int> bench_solve(const BenchOptions& options) {
  const Result<std::vector<ScenarioFile>> files =
      bench_scenarios(options.data, {"paper", "os0_t265", "os0_manta", "vlp16_blackfly"}, options.only);
  if (!files) return fail(files.error());
  if (!options.json) {
    std::printf(
        "One whole calibration with covariance and leave-one-out, features extracted, one thread: CPU time, "
        "median of %d.\n%-18s %5s %8s | %9s %9s | %9s\n%-18s %5s %8s | %9s %9s | %9s\n",
        options.repeats, "rig", "views", "returns", "planes", "+ rims", "per view", "", "", "per view", "ms",
        "ms", "ms");
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const ScenarioFile& file : *files) {
    const Result<nlohmann::json> one = measure(file, options);
    if (!one) return fail(one.error());
    rows.insert(rows.end(), one->begin(), one->end());
  }
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
