/// CPU time of one whole calibration from extracted features.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/solve/calibrate.h"
#include "tools/ca2/bench_accuracy_times.h"
#include "tools/ca2/bench_timing.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"

namespace ca2 {

Result<nlohmann::json> calibration_time(const ScenarioFile& file, int count, int repeats, bool quiet) {
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
  const double middle = median(ms);
  if (!quiet)
    std::printf("%-18s %4d views  %8.1f ms  %.3f ms per view\n", file.scenario.name.c_str(), count, middle,
                middle / count);
  return nlohmann::json{{"rig", file.scenario.name}, {"views", count}, {"ms", middle}};
}

}  // namespace ca2
