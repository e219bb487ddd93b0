/// A lens or a print that is not what the rig says: found where it is wrong, believed where it is right, and
/// either way the answer is as the covariance says.
#include <cstdio>

#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

constexpr int trials = 20;
constexpr int views_per_trial = 15;
constexpr const char* pair_name = "front";

/// A board whose print came out larger than stated.
class Stretched final : public BoardType {
 public:
  Stretched(const BoardType& stated, const Eigen::Vector2d& stretch) : stated_(stated), stretch_(stretch) {}
  std::string_view name() const override { return stated_.name(); }
  std::vector<std::string> invalid(const Board& board) const override { return stated_.invalid(board); }
  std::vector<Eigen::Vector2d> corners(const Board& board) const override {
    std::vector<Eigen::Vector2d> places = stated_.corners(board);
    for (Eigen::Vector2d& place : places) place += place.cwiseProduct(stretch_);
    return places;
  }
  Eigen::Vector2d pattern_size(const Board& board) const override { return stated_.pattern_size(board); }
  bool black(const Board& board, const Eigen::Vector2d& p) const override { return stated_.black(board, p); }
  bool half_turn_ambiguous(const Board& board) const override { return stated_.half_turn_ambiguous(board); }
  std::vector<Corner> find(const Board& board, const Image& grey8) const override {
    return stated_.find(board, grey8);
  }

 private:
  const BoardType& stated_;
  Eigen::Vector2d stretch_;
};

CalibrateOptions everything_believed() {
  CalibrateOptions options;
  options.prior_distortion = options.prior_stretch = options.prior_size = 0;
  return options;
}

struct Tally {
  int answers = 0, distortions = 0, prints = 0;
  double nees = 0;          // of the extrinsics, per degree of freedom
  double translation2 = 0;  // m^2

  void add(const Calibration& answer, const Scenario& scenario) {
    const CalibratedTransform& first = answer.transforms.front();
    const TransformError error = error_of(first, true_transform(scenario, first.parent, first.child));
    ++answers;
    nees += error.nees / (6 * trials);
    translation2 += error.translation * error.translation / trials;
    distortions += answer.cameras.at(pair_name).sigma[4] > 0 ? 1 : 0;
    prints += answer.print.estimated ? 1 : 0;
  }
  void print(const char* what) const {
    std::printf("%-28s %2d answers, %.2f mm rms, NEES/6 %.2f; distortion estimated in %d, print in %d\n",
                what, answers, 1e3 * std::sqrt(translation2), nees, distortions, prints);
  }
};

class CornerDoubts : public testing::Test {
 protected:
  ScenarioFile file = load("vlp16_blackfly_a3", 4001);

  void SetUp() override {
    for (auto& [name, camera] : file.scenario.cameras) camera.noise.corner_sigma = refined_corner_sigma;
  }

  /// Its distortion moves what is seen in the middle of the picture's left and right edge by 3 px.
  static Rig wrong_lens(Rig rig) {
    Camera& camera = *rig.cameras.at(pair_name).intrinsics;
    const double edge = 0.5 * camera.width / camera.parameters(0);
    camera.parameters(4) += 3 / (camera.parameters(0) * std::pow(edge, 3));
    return rig;
  }

  Tally run(const std::vector<SimulatedView>& pool, const Rig& rig, const CalibrateOptions& options) const {
    std::mt19937_64 rng(11);
    Tally tally;
    for (int trial = 0; trial < trials; ++trial) {
      const Rig stated = misstated_rig(rig, file.intrinsics_error, rng);
      const auto sights = sights_of(stated, draw_subset(pool, views_per_trial, rng));
      if (!sights) continue;
      if (const auto answer = calibrate(stated, *sights, options)) tally.add(*answer, file.scenario);
    }
    return tally;
  }
};

TEST_F(CornerDoubts, WhatIsRightIsBelieved) {
  const Tally tally = run(pool_of(file.scenario, 80), rig_of(file.scenario), {});
  tally.print("right");
  EXPECT_EQ(tally.answers, trials);
  EXPECT_EQ(tally.distortions, 0);
  EXPECT_EQ(tally.prints, 0);
}

TEST_F(CornerDoubts, AWrongDistortionIsEstimated) {
  const std::vector<SimulatedView> pool = pool_of(file.scenario, 80);
  const Rig wrong = wrong_lens(rig_of(file.scenario));
  const Tally found = run(pool, wrong, {});
  const Tally held = run(pool, wrong, everything_believed());
  const Tally right = run(pool, rig_of(file.scenario), {});
  found.print("wrong distortion");
  held.print("wrong distortion, held");
  right.print("right distortion");
  EXPECT_EQ(found.answers, trials);
  EXPECT_EQ(found.distortions, trials);
  EXPECT_EQ(found.prints, 0);
  EXPECT_EQ(held.distortions, 0);
  EXPECT_GT(found.nees, 0.3);
  EXPECT_LT(found.nees, 1.5);
  EXPECT_GT(held.nees, 2 * found.nees);
  EXPECT_GT(held.translation2, 2 * found.translation2);
  EXPECT_LT(std::sqrt(found.translation2), 0.00024);  // m
}

/// Cameras see what is longer one way. A print scaled to fit the page looks right to all of them: only the
/// LiDARs' metres tell.
TEST_F(CornerDoubts, APrintOfAnotherSizeIsEstimated) {
  const Rig stated = rig_of(file.scenario);
  struct Print {
    Eigen::Vector2d stretch;
    double least_gain;  ///< of the squared error
  };
  for (const Print& print :
       {Print{{0.003, -0.001}, 2}, {{-0.03, -0.03}, 100}, {{-0.03, -0.034}, 100}, {{0.01, 0.01}, 100}}) {
    SCOPED_TRACE(print.stretch.transpose());
    Scenario scenario = file.scenario;
    const Stretched printed(*scenario.board.type, print.stretch);
    scenario.board.type = &printed;
    const std::vector<SimulatedView> pool = pool_of(scenario, 80);
    const Tally found = run(pool, stated, {});
    const Tally held = run(pool, stated, everything_believed());
    found.print("print of another size");
    held.print("print of another size, held");
    EXPECT_EQ(found.answers, trials);
    EXPECT_EQ(found.prints, trials);
    EXPECT_EQ(found.distortions, 0);
    EXPECT_EQ(held.prints, 0);
    EXPECT_GT(found.nees, 0.3);
    EXPECT_LT(found.nees, 1.5);
    EXPECT_GT(held.nees, 2 * found.nees);
    EXPECT_GT(held.translation2, print.least_gain * found.translation2);
  }
}

}  // namespace
}  // namespace ca2
