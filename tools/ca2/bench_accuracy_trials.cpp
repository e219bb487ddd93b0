#include "tools/ca2/bench_accuracy_trials.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/solve/calibrate.h"
#include "tools/sim/cramer_rao.h"
#include "tools/sim/feature_sights.h"

namespace ca2 {
namespace {

constexpr double chi2_95_6 = 12.592;  // of chi-squared with 6 degrees of freedom

/// Trace of the covariance's blocks.
struct Bound {
  double translation2 = 0;  // m^2
  double rotation2 = 0;     // rad^2
};

std::optional<Bound> bound_of(const Scenario& scenario, const Rig& rig,
                              const std::vector<SimulatedView>& views, const CalibrateOptions& priors,
                              bool edges) {
  const auto covariance = cramer_rao(scenario, rig, views,
                                     {.edges = edges,
                                      .prior_focal = priors.prior_focal,
                                      .prior_center = priors.prior_center,
                                      .prior_bias = priors.prior_bias});
  if (!covariance) return std::nullopt;
  return Bound{covariance->bottomRightCorner<3, 3>().trace(), covariance->topLeftCorner<3, 3>().trace()};
}

void add(MethodErrors& errors, const Result<Calibration>& answer, const Scenario& scenario,
         const std::optional<Bound>& bound) {
  if (!answer) return;
  const CalibratedTransform& first = answer->transforms.front();
  const TransformError e = error_of(first, true_transform(scenario, first.parent, first.child));
  ++errors.answers;
  errors.translation += e.translation;
  errors.translation2 += e.translation * e.translation;
  errors.rotation += e.rotation;
  errors.rotation2 += e.rotation * e.rotation;
  errors.nees += e.nees;
  errors.covered += e.nees <= chi2_95_6 ? 1 : 0;
  if (!bound) return;
  ++errors.bounded;
  errors.ratio_translation2 += e.translation * e.translation / bound->translation2;
  errors.ratio_rotation2 += e.rotation * e.rotation / bound->rotation2;
}

/// One subset of views, solved by every method.
Result<void> measure(const Scenario& scenario, const Rig& stated, const std::vector<SimulatedView>& views,
                     const HeldValues& held, AccuracyCell& cell) {
  const Result<std::vector<ViewSights>> sights = sights_of(stated, views);
  if (!sights) return fail(sights.error());
  const std::vector<ViewSights> planes = without_crossings(*sights);
  const CalibrateOptions own = holding({}, held);
  const auto joint = calibrate(stated, planes, own);
  if (!joint) return {};
  const Rig rig = rig_of(scenario);
  const auto bound = bound_of(scenario, rig, views, own, false);
  const auto edge_bound = bound_of(scenario, rig, views, own, true);
  ++cell.trials;
  if (bound && edge_bound) {
    cell.bound_translation += bound->translation2;
    cell.bound_rotation += bound->rotation2;
    cell.edge_bound_translation += edge_bound->translation2;
    cell.edge_bound_rotation += edge_bound->rotation2;
  }
  add(cell.methods[joint_name], joint, scenario, bound);
  add(cell.methods[edges_name], calibrate(stated, *sights, own), scenario, edge_bound);
  for (const auto& [name, method] :
       {std::pair{planes_name, Method::plane_to_plane}, {kim_name, Method::kim}}) {
    CalibrateOptions options;
    options.method = method;
    add(cell.methods[name], calibrate(stated, planes, options), scenario, bound);
  }
  return {};
}

double root_mean(double sum, int count) {
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

double MethodErrors::ratio_translation() const {
  return root_mean(ratio_translation2, bounded);
}

double MethodErrors::ratio_rotation() const {
  return root_mean(ratio_rotation2, bounded);
}

nlohmann::json AccuracyCell::json() const {
  nlohmann::json out{{"experiment", experiment},
                     {"views", views},
                     {"trials", trials},
                     {"bound_translation_mm", 1e3 * bound_translation},
                     {"bound_rotation_mrad", 1e3 * bound_rotation},
                     {"edge_bound_translation_mm", 1e3 * edge_bound_translation},
                     {"edge_bound_rotation_mrad", 1e3 * edge_bound_rotation}};
  for (const auto& [name, errors] : methods) {
    out["methods"][name] = {{"answers", errors.answers},
                            {"translation_mean_mm", 1e3 * errors.mean_translation()},
                            {"translation_rms_mm", 1e3 * root_mean(errors.translation2, errors.answers)},
                            {"rotation_mean_mrad", 1e3 * errors.rotation / std::max(1, errors.answers)},
                            {"rotation_rms_mrad", 1e3 * root_mean(errors.rotation2, errors.answers)},
                            {"translation_over_bound", errors.ratio_translation()},
                            {"rotation_over_bound", errors.ratio_rotation()},
                            {"nees_per_6", errors.mean_nees()},
                            {"covered_95", errors.covered / std::max(1.0, double(errors.answers))}};
  }
  return out;
}

Result<std::vector<AccuracyCell>> run_accuracy(const AccuracyExperiment& experiment, int trials,
                                               std::uint64_t seed, const std::function<void(int)>& progress) {
  std::vector<AccuracyCell> cells;
  for (const int count : experiment.view_counts) {
    AccuracyCell& cell = cells.emplace_back();
    cell.experiment = experiment.name;
    cell.views = count;
  }
  // Every experiment has draws of its own, and the same ones whatever else is run beside it.
  std::uint64_t own = seed;
  for (const char letter : experiment.name) own = own * 1099511628211u + static_cast<unsigned char>(letter);
  std::mt19937_64 rng(own);
  for (int trial = 0; trial < trials; ++trial) {
    Scenario scenario = experiment.file.scenario;
    scenario.seed = rng();
    for (auto& [name, lidar] : scenario.lidars) {
      if (!(experiment.most_bias > 0)) continue;
      const double size = std::uniform_real_distribution(experiment.least_bias, experiment.most_bias)(rng);
      lidar.noise.range_bias = std::bernoulli_distribution()(rng) ? size : -size;
    }
    const Result<std::vector<SimulatedView>> pool = simulate_pool(scenario, experiment.pool);
    if (!pool) return fail(pool.error());
    const Rig stated = misstated_rig(rig_of(scenario), experiment.file.intrinsics_error, rng);
    for (AccuracyCell& cell : cells) {
      if (auto done = measure(scenario, stated, draw_subset(*pool, cell.views, rng), experiment.held, cell);
          !done)
        return fail(done.error());
    }
    progress(trial + 1);
  }
  for (AccuracyCell& cell : cells) {
    for (double* sum : {&cell.bound_translation, &cell.bound_rotation, &cell.edge_bound_translation,
                        &cell.edge_bound_rotation})
      *sum = root_mean(*sum, cell.trials);
  }
  return cells;
}

}  // namespace ca2
