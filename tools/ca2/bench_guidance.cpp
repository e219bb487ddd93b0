/// `ca2 bench guidance`: how many times the board must be held until the stop rule is met, by a person who
/// shows the poses that are asked for, and by one who shows any.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/geometry/so3.h"
#include "core/guidance/next_pose.h"
#include "core/solve/calibrate.h"
#include "core/types/text.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_scenarios.h"
#include "tools/ca2/progress.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"
#include "tools/sim/placement.h"

namespace ca2 {
namespace {

constexpr int most_holds = 60;
// Nobody holds a board just where he is told to.
constexpr double person_place = 0.1;                    // m, along each axis
constexpr double person_turn = 5 * M_PI / 180;          // rad, about each axis
constexpr double refined_corner = 0.010 / 0.007;        // px per noise of a picture (refine_test)
constexpr SigmaTarget daemons, finer{0.5e-3, 0.25e-3};  // the stop rule by default, and a harder one

struct Outcome {
  int holds = most_holds;  ///< shown, seen or not
  int in_vain = 0;         ///< of them: the camera or the LiDAR did not see enough of the board
  bool reached = false;
  double error = 0;  ///< m, against the truth
};

ElevationRange elevations(const BeamTable& beams) {
  ElevationRange range{M_PI / 2, -M_PI / 2};
  for (const BeamRay& ray : beams.rays) {
    const double elevation = std::asin(std::clamp(ray.direction.z(), -1.0, 1.0));
    range.low = std::min(range.low, elevation);
    range.high = std::max(range.high, elevation);
  }
  return range;
}

bool met(const Calibration& calibration, const SigmaTarget& target) {
  return std::all_of(calibration.transforms.begin(), calibration.transforms.end(), [&](const auto& t) {
    return t.sigma_translation() <= target.translation && t.sigma_rotation() <= target.rotation;
  });
}

/// One calibration, from the first hold on.
class Person {
 public:
  Person(const Scenario& scenario, const SigmaTarget& target, std::uint64_t seed)
      : scenario_(scenario), target_(target), rig_(rig_of(scenario)), rng_(seed) {
    for (const auto& [name, lidar] : scenario.lidars) elevations_.push_back(elevations(lidar.beams));
  }

  Result<Outcome> run(bool guided) {
    Outcome outcome;
    for (int hold = 1; hold <= most_holds; ++hold) {
      const Result<Pose> pose = guided ? advised(hold) : anywhere(hold);
      if (!pose) return fail(pose.error());
      if (auto shown = show(*pose); !shown) return fail(shown.error());
      const Result<Calibration> answer = calibrate(rig_, views_, {});
      calibration_ = answer ? std::optional(*answer) : std::nullopt;
      if (!answer || !met(*answer, target_)) continue;
      outcome.holds = hold;
      outcome.in_vain = hold - static_cast<int>(views_.size());
      outcome.reached = true;
      for (const CalibratedTransform& t : answer->transforms) {
        const Pose truth = true_transform(scenario_, t.parent, t.child);
        outcome.error = std::max(outcome.error, error_of(t, truth).translation);
      }
      break;
    }
    return outcome;
  }

 private:
  Result<Pose> anywhere(int hold) { return place_board(scenario_, sensors_of_view(scenario_, hold), rng_); }

  /// Roughly the pose that is asked for.
  Result<Pose> advised(int hold) {
    const auto next = calibration_ ? suggest_next_pose(rig_, *calibration_, views_, elevations_, target_)
                                   : suggest_first_pose(rig_, views_);
    if (!next) return anywhere(hold);
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto draw = [&](double size) {
      const double x = size * unit(rng_), y = size * unit(rng_), z = size * unit(rng_);
      return Eigen::Vector3d(x, y, z);
    };
    Pose held = next->T_camera_board;
    held.t += draw(person_place);
    held.R *= so3_exp(draw(person_turn));
    return scenario_.cameras.at(next->camera).T_rig_camera * held;
  }

  /// Without a camera and a LiDAR that see the board it is a hold in vain.
  Result<void> show(const Pose& T_rig_board) {
    SimulatedView view = observe_features(scenario_, T_rig_board, rng_);
    const std::size_t all = scenario_.board.type->corners(scenario_.board).size();
    for (auto& [name, corners] : view.corners) {
      if (corners.size() < all) corners.clear();  // a checkerboard is found whole or not at all
    }
    for (auto& [name, scan] : view.board_returns) {
      if (static_cast<int>(scan.size()) < scenario_.placement.min_returns) scan = {};
    }
    Result<std::vector<ViewSights>> sights = sights_of(rig_, {view});
    if (!sights) return fail(sights.error());
    ViewSights& seen = sights->front();
    seen.id = static_cast<int>(views_.size()) + 1;
    const bool camera = std::any_of(seen.cameras.begin(), seen.cameras.end(),
                                    [](const auto& sight) { return sight.has_value(); });
    const bool lidar = std::any_of(seen.lidars.begin(), seen.lidars.end(),
                                   [](const auto& sights_of_one) { return !sights_of_one.empty(); });
    if (camera && lidar) views_.push_back(std::move(seen));
    return {};
  }

  const Scenario& scenario_;
  SigmaTarget target_;
  Rig rig_;
  std::mt19937_64 rng_;
  std::vector<ElevationRange> elevations_;
  std::vector<ViewSights> views_;
  std::optional<Calibration> calibration_;
};

template <class Value>
Value median(std::vector<Value> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// "7 (5 to 9), 3 %"; holds that did not suffice count as the most there may be.
std::string holds_text(const std::vector<Outcome>& outcomes) {
  std::vector<int> holds;
  int all = 0, in_vain = 0;
  for (const Outcome& outcome : outcomes) {
    holds.push_back(outcome.holds);
    all += outcome.holds;
    in_vain += outcome.in_vain;
  }
  const auto [low, high] = std::minmax_element(holds.begin(), holds.end());
  return formatted("%d (%d to %d), %d %%", median(holds), *low, *high, 100 * in_vain / all);
}

nlohmann::json summary(const std::vector<Outcome>& outcomes) {
  std::vector<int> holds;
  std::vector<double> errors;
  int reached = 0, in_vain = 0;
  for (const Outcome& outcome : outcomes) {
    holds.push_back(outcome.holds);
    in_vain += outcome.in_vain;
    reached += outcome.reached ? 1 : 0;
    if (outcome.reached) errors.push_back(outcome.error);
  }
  return {{"holds", holds},
          {"median_holds", median(holds)},
          {"in_vain", in_vain},
          {"reached", reached},
          {"median_error_m", errors.empty() ? 0.0 : median(errors)}};
}

/// Both ways with the same seeds.
Result<nlohmann::json> compare(const ScenarioFile& file, const SigmaTarget& target, int trials,
                               const BenchOptions& options) {
  std::vector<Outcome> outcomes[2];
  Progress progress(file.scenario.name);
  for (int trial = 0; trial < trials; ++trial) {
    for (const bool guided : {true, false}) {
      const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(trial);
      Result<Outcome> outcome = Person(file.scenario, target, seed).run(guided);
      if (!outcome) return fail(outcome.error());
      outcomes[guided ? 0 : 1].push_back(*outcome);
    }
    progress.show(trial + 1, trials);
  }
  nlohmann::json row = {{"rig", file.scenario.name},
                        {"target_translation", target.translation},
                        {"target_rotation", target.rotation},
                        {"advised", summary(outcomes[0])},
                        {"random", summary(outcomes[1])}};
  if (options.json) return row;
  std::printf("%-18s %4.1f %5.2f | %-18s %5.2f | %-18s %5.2f\n", file.scenario.name.c_str(),
              1e3 * target.translation, 1e3 * target.rotation, holds_text(outcomes[0]).c_str(),
              1e3 * row["advised"]["median_error_m"].get<double>(), holds_text(outcomes[1]).c_str(),
              1e3 * row["random"]["median_error_m"].get<double>());
  std::fflush(stdout);
  return row;
}

}  // namespace

Result<int> bench_guidance(const BenchOptions& options) {
  Result<std::vector<ScenarioFile>> files = bench_scenarios(
      options.data, {"os0_manta", "os0_t265", "vlp16_blackfly_a3", "vlp16_blackfly"}, options.only);
  if (!files) return fail(files.error());
  const int trials = options.trials > 0 ? options.trials : 21;
  nlohmann::json rows = nlohmann::json::array();
  if (!options.json) {
    std::printf(
        "Holds until the sigmas are met, median of %d seeds (least to most), share in vain (out of a "
        "sensor's "
        "sight);\nerror: of translation, mm, median at the end\n\n%-18s %4s %5s | %-18s error | %-18s "
        "error\n",
        trials, "rig", "mm", "mrad", "as advised", "at random");
  }
  for (ScenarioFile& file : *files) {
    for (auto& [camera_name, camera] : file.scenario.cameras)
      camera.noise.corner_sigma = refined_corner * camera.noise.sigma;
    for (const SigmaTarget& target : {daemons, finer}) {
      auto row = compare(file, target, trials, options);
      if (!row) return fail(row.error());
      rows.push_back(std::move(*row));
    }
  }
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
