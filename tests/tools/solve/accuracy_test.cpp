/// Error and honesty of the whole estimator over random subsets of simulated views, with intrinsics as wrong
/// as the scenarios say and no initial guess, beside the published method on the same subsets.
#include <cstdio>

#include "tests/support/left_out.h"
#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

constexpr int trials = 40;

struct Tally {
  int answers = 0;
  double translation = 0;  // m, sum
  double rotation = 0;     // rad, sum
  double nees = 0;
  int used = 0;

  double mean_translation() const { return translation / answers; }
  double mean_nees() const { return nees / (6 * answers); }

  void add(const Calibration& calibration, const Scenario& scenario) {
    const TransformError error = worst_error(calibration, scenario);
    ++answers;
    translation += error.translation;
    rotation += error.rotation;
    for (const CalibratedView& view : calibration.views) used += view.used ? 1 : 0;
    // One pair: pairs of a rig that share a sensor are not independent trials.
    const CalibratedTransform& first = calibration.transforms.front();
    nees += error_of(first, true_transform(scenario, first.parent, first.child)).nees;
  }
};

class Accuracy : public testing::TestWithParam<const char*> {};

TEST_P(Accuracy, ErrorsAreSmallAndAsTheCovarianceSays) {
  if (test::left_out(GetParam())) GTEST_SKIP() << "built without this rig's board";
  ScenarioFile file = load(GetParam(), 1001);
  if (file.scenario.name == "paper") {
    for (auto& [name, camera] : file.scenario.cameras) camera.noise.corner_sigma = refined_corner_sigma;
  }
  const std::vector<SimulatedView> pool = pool_of(file.scenario, 80);
  const Rig rig = rig_of(file.scenario);
  std::mt19937_64 rng(7);
  std::map<int, Tally> joint, planes;
  for (const int count : {3, 5, 10, 20}) {
    for (int trial = 0; trial < trials; ++trial) {
      const Rig stated = misstated_rig(rig, file.intrinsics_error, rng);
      const std::vector<SimulatedView> views = draw_subset(pool, count, rng);
      // Three or five random views may not determine the answer: being refused is right then.
      if (const auto answer = calibrate_features(stated, views)) joint[count].add(*answer, file.scenario);
      if (const auto answer = calibrate_features(stated, views, Method::plane_to_plane))
        planes[count].add(*answer, file.scenario);
    }
    const Tally& ours = joint[count];
    std::printf(
        "%-15s N = %2d: joint %2d answers, mean %.2f mm %.2f mrad, NEES/6 %.2f, %.1f views used; "
        "plane_to_plane %2d, %.2f mm\n",
        GetParam(), count, ours.answers, 1e3 * ours.mean_translation(), 1e3 * ours.rotation / ours.answers,
        ours.mean_nees(), static_cast<double>(ours.used) / ours.answers, planes[count].answers,
        1e3 * planes[count].mean_translation());
    ASSERT_GE(ours.answers, count > 3 ? trials - 2 : trials / 2) << count << " views";
    EXPECT_GT(ours.mean_nees(), 0.6) << count << " views";
    EXPECT_LT(ours.mean_nees(), 1.6) << count << " views";
    EXPECT_GE(ours.used, count * ours.answers * 98 / 100) << "right views thrown out, of " << count;
    if (count < 10) continue;
    EXPECT_EQ(ours.answers, trials) << count << " views";
    EXPECT_LE(ours.mean_translation(), 0.003) << count << " views";
    EXPECT_GE(planes[count].mean_translation(), 3 * ours.mean_translation()) << count << " views";
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, Accuracy, testing::Values("paper", "os0_t265", "os0_manta", "vlp16_blackfly"),
                         [](const auto& rig) { return std::string(rig.param); });

}  // namespace
}  // namespace ca2
