/// What a rim's sums are made anew for.
#include "core/solve/rim_memo.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "tests/core/solve/rim_scan.h"

namespace ca2 {
namespace {

constexpr double slack = 0.025;  // m

class RimMemoTest : public testing::Test {
 protected:
  const Pose T_ = plate_at(0.3);
  const std::vector<EdgeCrossing> crossings_ = scan_rim(T_, {.phase = 0.2});
  RimMemo memo_;

  std::vector<EdgeSums> sums(const Vector6d& move, const EdgeNoise& noise = {}) {
    return memo_.sums(crossings_, test_plate, T_.perturbed(move), {}, noise, slack);
  }
};

/// In sigmas: sums made for a place beside say the same of the plate where it is.
TEST_F(RimMemoTest, AHairsBreadthChangesNothing) {
  const std::vector<EdgeSums> first = sums(Vector6d::Zero());
  ASSERT_EQ(first.size(), 4u);
  const Vector6d move = 3e-5 * Vector6d::Ones();
  const std::vector<EdgeSums> kept = sums(move);
  const std::vector<EdgeSums> anew = edge_sums(crossings_, test_plate, T_.perturbed(move), {}, {}, slack);
  ASSERT_EQ(anew.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(kept[i].rows, first[i].rows);
    const Eigen::Vector4d z = kept[i].at(T_, {});
    const Eigen::Vector2d off = kept[i].rows * z - anew[i].rows * z;
    EXPECT_LT(std::sqrt(off.dot(kept[i].covariance.ldlt().solve(off))), 0.003);
  }
}

TEST_F(RimMemoTest, FurtherMovesAndOtherBlursAreLookedAt) {
  const std::vector<EdgeSums> first = sums(Vector6d::Zero());
  EXPECT_NE(sums(2e-4 * Vector6d::Unit(3))[0].rows, first[0].rows);
  EXPECT_NE(sums(Vector6d::Zero(), {1e-3, 0, 0, 0})[0].covariance, first[0].covariance);
}

}  // namespace
}  // namespace ca2
