/// Rims seen by beams that begin in a lens or on the axis: which of both they are told to be.
#include "core/solve/lens_evidence.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/core/solve/rim_scan.h"

namespace ca2 {
namespace {

constexpr double slack = 0.025;

/// A plate held at `count` places, half a metre up and down, tilted either way, 1.2 to 3 m away.
struct Holds {
  std::vector<std::vector<EdgeCrossing>> crossings;
  std::vector<EdgeView> views;

  Holds(int count, RimScan how) {
    std::mt19937_64 rng(11);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Pose> poses;
    for (int i = 0; i < count; ++i) {
      Pose T = plate_at(0.8 + 0.4 * unit(rng));
      T.R = T.R * Eigen::AngleAxisd(0.5 * unit(rng), Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(0.5 * unit(rng), Eigen::Vector3d::UnitY());
      T.t = {2.1 + 0.9 * unit(rng), 0.3 * unit(rng), 0.4 * unit(rng)};
      how.phase = 0.5 * unit(rng);
      poses.push_back(T);
      crossings.push_back(scan_rim(T, how));
    }
    for (std::size_t i = 0; i < poses.size(); ++i) views.push_back({crossings[i], test_plate, poses[i]});
  }

  double lens() const { return lens_gain(views, {how_wide, 0}, 0, slack, {}, 0.04); }
  static constexpr double how_wide = 0.001;  // rad
};

TEST(LensEvidence, BeamsThatBeginOnTheAxisAreBelieved) {
  EXPECT_LT(Holds(10, {.dilation = {0.001, 0}}).lens(), -20);
}

TEST(LensEvidence, BeamsThatBeginInTheLensAreTold) {
  EXPECT_GT(Holds(10, {.dilation = {0.001, 0}, .lens = 0.04}).lens(), 20);
}

TEST(LensEvidence, FewRimsTellNothing) {
  EXPECT_EQ(Holds(2, {.lens = 0.04}).lens(), 0);
  EXPECT_EQ(Holds(0, {}).lens(), 0);
}

}  // namespace
}  // namespace ca2
