/// One and two views, which planes alone leave open: what the plate's rim and the intensities of its print
/// make of them, and that nothing is answered that they leave open. Three views that planes leave wide.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "tests/support/left_out.h"
#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

/// As real LiDARs have them: a tenth of noise, and a gain of every laser's own.
std::vector<ViewSights> with_rough_intensities(std::vector<ViewSights> views, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(1, 0.1);
  std::uniform_real_distribution<double> gain(0.6, 1);
  std::map<std::pair<std::size_t, int>, double> gains;
  for (ViewSights& view : views) {
    for (std::size_t l = 0; l < view.lidars.size(); ++l) {
      for (LidarSight& sight : view.lidars[l]) {
        for (BoardReturn& here : sight.on_board) {
          double& own = gains.try_emplace({l, here.ring}, gain(rng)).first->second;
          here.intensity =
              static_cast<std::uint16_t>(std::clamp(own * noise(rng) * here.intensity, 0., 65000.));
        }
      }
    }
  }
  return views;
}

/// What a person who measured with a tape writes into the rig.
RigExtrinsic tape_measured(const Scenario& scenario, const std::string& parent, const std::string& child,
                           std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Vector6d off;
  for (int k = 0; k < 6; ++k) off(k) = (k < 3 ? 0.2 : 0.15) * unit(rng);
  return {parent, child, true_transform(scenario, parent, child).perturbed(off), false};
}

std::vector<ViewSights> seen(const Rig& rig, const std::vector<SimulatedView>& views, std::mt19937_64& rng) {
  Result<std::vector<ViewSights>> sights = sights_of(rig, views);
  if (!sights) throw std::runtime_error(sights.error().text());
  return with_rough_intensities(*std::move(sights), rng);
}

struct Case {
  const char* scenario;
  int views;
  bool guess;
};

class FewViewsOf : public testing::TestWithParam<Case> {};

TEST_P(FewViewsOf, ErrorsAreAsTheCovarianceSays) {
  const auto& [name, count, guess] = GetParam();
  if (test::left_out(name)) GTEST_SKIP() << "built without this rig's board";
  ScenarioFile file = load(name, 5001);
  std::mt19937_64 rng(17);
  std::normal_distribution<double> normal;
  int answers = 0;
  double translation = 0, nees = 0, worst = 0;
  std::map<std::string, int> refusals;
  constexpr int trials = 60;
  for (int trial = 0; trial < trials; ++trial) {
    // Nothing is left over that could tell how wrong given values are: as wrong as the priors have them.
    const CalibrateOptions priors;
    file.scenario.seed = rng();
    for (auto& [lidar, sensor] : file.scenario.lidars)
      sensor.noise.range_bias = priors.prior_bias * normal(rng);
    Rig rig = rig_of(file.scenario);
    for (auto& [camera, sensor] : rig.cameras) {
      CameraParameters& k = sensor.intrinsics->parameters;
      for (int i = 0; i < 4; ++i)
        k(i) += (i < 2 ? priors.prior_focal * k(i) : priors.prior_center) * normal(rng);
    }
    const std::string camera = rig.cameras.begin()->first, lidar = rig.lidars.begin()->first;
    if (guess) {
      rig.extrinsics.push_back(tape_measured(file.scenario, camera, lidar, rng));
      for (auto other = std::next(rig.cameras.begin()); other != rig.cameras.end(); ++other)
        rig.extrinsics.push_back(tape_measured(file.scenario, camera, other->first, rng));
    }
    const auto answer = calibrate(rig, seen(rig, pool_of(file.scenario, count), rng), {});
    if (!answer) {
      EXPECT_EQ(answer.error().code, ErrorCode::refused);
      ++refusals[answer.error().problems.front().what.substr(0, 60)];
      continue;
    }
    EXPECT_EQ(answer->observability.verdict, "weak");
    const CalibratedTransform& first = answer->transforms.front();
    const TransformError error = error_of(first, true_transform(file.scenario, first.parent, first.child));
    ++answers;
    translation += error.translation;
    nees += error.nees / 6;
    worst = std::max(worst, error.nees);
  }
  std::printf("%-18s N = %d: %2d answers of %d, mean %.2f mm, NEES/6 %.2f, worst %.1f sigma\n", name, count,
              answers, trials, 1e3 * translation / answers, nees / answers, std::sqrt(worst / 6));
  for (const auto& [words, times] : refusals) std::printf("  %2d times %s\n", times, words.c_str());
  EXPECT_GE(answers, trials / 2);
  // Rims are taken to err a little more than those of this simulator do.
  EXPECT_GT(nees / answers, 0.5);
  EXPECT_LT(nees / answers, 1.5);
  EXPECT_LT(std::sqrt(worst / 6), 5);
}

INSTANTIATE_TEST_SUITE_P(
    Rigs, FewViewsOf,
    testing::Values(Case{"paper", 1, false}, Case{"paper", 2, false}, Case{"os0_manta", 1, false},
                    Case{"os0_manta", 2, false}, Case{"os0_t265", 1, true}, Case{"os0_t265", 2, false},
                    Case{"vlp16_blackfly_a3", 1, true}, Case{"vlp16_blackfly_a3", 2, false}),
    [](const auto& rig) { return std::string(rig.param.scenario) + (rig.param.views == 1 ? "One" : "Two"); });

/// The words of a refusal; empty for an answer.
std::string refusal(const Result<Calibration>& answer) {
  if (answer) return "";
  EXPECT_EQ(answer.error().code, ErrorCode::refused);
  return answer.error().text();
}

TEST(FewViews, TwoAnswersAreRefused) {
  const Scenario scenario = load("os0_t265", 5101).scenario;
  Rig rig = rig_of(scenario);
  rig.cameras.erase("right");
  std::mt19937_64 rng(3);
  for (const SimulatedView& view : pool_of(scenario, 10)) {
    const std::vector<ViewSights> one = seen(rig, {view}, rng);
    const std::string words = refusal(calibrate(rig, one, {}));
    EXPECT_NE(words.find("two answers, half a turn apart"), std::string::npos) << words;
    EXPECT_NE(words.find("so does its pattern"), std::string::npos) << words;
    // A guess that fits neither, and one that fits the right one.
    Rig guessed = rig;
    Pose other = true_transform(scenario, "left", "top");
    other.R = other.R * so3_exp({0, 0, 1.2});
    guessed.extrinsics = {{"left", "top", other, false}};
    EXPECT_FALSE(refusal(calibrate(guessed, one, {})).empty());
    guessed.extrinsics = {{"left", "top", true_transform(scenario, "left", "top"), false}};
    EXPECT_EQ(refusal(calibrate(guessed, one, {})), "");
  }
}

TEST(FewViews, WithoutIntensitiesNothingTellsWhichWayRoundThePlateIs) {
  const Scenario scenario = load("paper", 5102).scenario;
  const Rig rig = rig_of(scenario);
  std::mt19937_64 rng(4);
  for (const SimulatedView& view : pool_of(scenario, 10)) {
    std::vector<ViewSights> one = seen(rig, {view}, rng);
    EXPECT_EQ(refusal(calibrate(rig, one, {})), "");
    for (BoardReturn& here : one[0].lidars[0][0].on_board) here.intensity = BoardReturn::no_intensity;
    const std::string words = refusal(calibrate(rig, one, {}));
    EXPECT_NE(words.find("intensities of its squares do not tell"), std::string::npos) << words;
  }
}

TEST(FewViews, TwoCamerasAndOneViewOfAPatternThatLooksAlikeBothWays) {
  const Scenario scenario = load("os0_t265", 5103).scenario;
  const Rig rig = rig_of(scenario);
  std::mt19937_64 rng(5);
  const std::string words = refusal(calibrate(rig, seen(rig, pool_of(scenario, 1), rng), {}));
  EXPECT_NE(words.find("how this camera sits"), std::string::npos) << words;
}

TEST(FewViews, TwoParallelBoardsAreRefused) {
  const Scenario scenario = load("paper", 5106).scenario;
  const Rig rig = rig_of(scenario);
  std::mt19937_64 rng(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  int parallel = 0;
  constexpr int trials = 40;
  for (int trial = 0; trial < trials; ++trial) {
    const double turn = 0.5 * unit(rng), tip = 0.3 * unit(rng), half_degree = 0.5 * M_PI / 180;
    std::vector<SimulatedView> views;
    for (int v = 0; v < 2; ++v) {
      const Eigen::Vector3d place(0.3 * unit(rng), 0.15 * unit(rng), 2.5 + 0.5 * unit(rng));
      const Eigen::Vector3d turned(tip, turn + v * half_degree * unit(rng), 0);
      const Pose T_camera_board{so3_exp(turned) * so3_exp({0, 0, 0.5 * unit(rng)}), place};
      views.push_back(observe_features(scenario, scenario.T_rig_sensor("camera") * T_camera_board, rng));
    }
    const std::string words = refusal(calibrate(rig, seen(rig, views, rng), {}));
    EXPECT_FALSE(words.empty());
    parallel += words.find("nearly parallel") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(parallel, trials * 3 / 4);
}

/// A plate of the board's size that has no print, where another view has the board.
LidarSight bare_plate(LidarSight sight, std::mt19937_64& rng) {
  std::normal_distribution<double> normal(30000, 3000);
  for (BoardReturn& here : sight.on_board) here.intensity = static_cast<std::uint16_t>(normal(rng));
  return sight;
}

TEST(FewViews, OtherPlatesBesideTheBoardAreNotTakenForIt) {
  int answers = 0, refused = 0;
  for (const char* name : {"paper", "vlp16_blackfly_a3"}) {
    const ScenarioFile file = load(name, 5104);
    const std::vector<SimulatedView> pool = pool_of(file.scenario, 60);
    Rig rig = rig_of(file.scenario);
    std::mt19937_64 rng(6);
    const std::string camera = rig.cameras.begin()->first, lidar = rig.lidars.begin()->first;
    for (int trial = 0; trial < 60; ++trial) {
      const int count = 1 + trial % 2;
      const std::vector<SimulatedView> drawn = draw_subset(pool, 2 * count, rng);
      std::vector<ViewSights> views = seen(rig, drawn, rng);
      for (int v = 0; v < count; ++v) {
        auto& hypotheses = views[v].lidars[0];
        hypotheses.insert(hypotheses.begin(), bare_plate(views[v + count].lidars[0][0], rng));
      }
      views.resize(count);
      const auto answer = calibrate(rig, views, {});
      if (!answer) {
        ++refused;
        continue;
      }
      ++answers;
      EXPECT_LT(std::sqrt(worst_error(*answer, file.scenario).nees / 6), 5) << name << " " << trial;
    }
  }
  std::printf("other plates: %d answers, %d refused\n", answers, refused);
  EXPECT_GE(answers, 60);
}

// The LiDAR saw the board where it was before, or something of its size: two views tell.
TEST(FewViews, ViewsThatContradictEachOtherAreRefused) {
  int answers = 0, refused = 0;
  for (const char* name : {"paper", "vlp16_blackfly_a3", "os0_t265"}) {
    ScenarioFile file = load(name, 5105);
    const std::vector<SimulatedView> right = pool_of(file.scenario, 30);
    file.scenario.wrong_fraction = 1;
    const Rig rig = rig_of(file.scenario);
    std::mt19937_64 rng(7);
    for (const WrongObject kind : {WrongObject::panel, WrongObject::moved}) {
      file.scenario.wrong_object = kind;
      const std::vector<SimulatedView> wrong = pool_of(file.scenario, 30);
      for (int trial = 0; trial < 30; ++trial) {
        const auto answer = calibrate(rig, seen(rig, {right[trial], wrong[trial]}, rng), {});
        answers += answer ? 1 : 0;
        refused += answer ? 0 : 1;
        if (answer) {
          EXPECT_LT(std::sqrt(worst_error(*answer, file.scenario).nees / 6), 5) << name << " " << trial;
        }
      }
    }
  }
  std::printf("contradicting views: %d answers, %d refused\n", answers, refused);
  EXPECT_GE(refused, 175);
}

TEST(FewViews, RimsFindTheBoardWhereThreePlanesPutItFarOff) {
  if (test::left_out("paper")) GTEST_SKIP() << "built without this rig's board";
  std::mt19937_64 rng(80);
  int wide = 0;
  double worst = 0, worst_translation = 0;
  for (std::uint64_t seed = 9100; seed < 9106; ++seed) {
    const Scenario scenario = load("paper", seed).scenario;
    const Rig rig = rig_of(scenario);
    Rig bare = rig;
    bare.board.outline.reset();
    const std::vector<SimulatedView> pool = pool_of(scenario, 60);
    for (int trial = 0; trial < 40; ++trial) {
      const std::vector<SimulatedView> views = draw_subset(pool, 3, rng);
      if (calibrate_features(bare, views)) continue;  // planes leave little
      const auto answer = calibrate_features(rig, views);
      if (!answer) continue;
      ++wide;
      const TransformError error = worst_error(*answer, scenario);
      worst = std::max(worst, error.nees / 6);
      worst_translation = std::max(worst_translation, error.translation);
    }
  }
  std::printf("%d answers where planes refuse, worst %.1f mm, NEES/6 %.1f\n", wide, 1e3 * worst_translation,
              worst);
  EXPECT_GT(wide, 5);
  EXPECT_LT(worst, 4);
  EXPECT_LT(worst_translation, 0.03);
}

}  // namespace
}  // namespace ca2
