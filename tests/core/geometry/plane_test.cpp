#include "core/geometry/plane.h"

#include <gtest/gtest.h>

#include <random>

namespace ca2 {
namespace {

TEST(Plane, FitRecoversAPlaneAndFacesTheOrigin) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  for (int i = 0; i < 50; ++i) {
    const Pose T{so3_exp({normal(rng), normal(rng), normal(rng)}), {normal(rng), normal(rng), 4}};
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k < 200; ++k) points.push_back(T * Eigen::Vector3d(uniform(rng), uniform(rng), 0));
    double rms = 1;
    const Plane plane = fit_plane(points, &rms);
    EXPECT_LT(rms, 1e-7);
    EXPECT_GE(plane.offset, 0);
    EXPECT_NEAR(std::abs(plane.normal.dot(T.R.col(2))), 1, 1e-12);
    EXPECT_NEAR(plane.distance(T.t), 0, 1e-9);
  }
}

TEST(Plane, TransformMovesItsPoints) {
  std::mt19937_64 rng(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Plane plane =
        facing_origin({Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized(), normal(rng)});
    const Pose T{so3_exp({normal(rng), normal(rng), normal(rng)}), {normal(rng), normal(rng), normal(rng)}};
    const Plane moved = transform(T, plane);
    EXPECT_NEAR(moved.distance(T * plane.foot()), 0, 1e-12);
    EXPECT_GE(moved.offset, 0);
    const Plane back = transform(T.inverse(), moved);
    EXPECT_LT((back.foot() - plane.foot()).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace ca2
