/// What rays leave for a straight rim.
#include "core/solve/rim_polygon.h"

#include <gtest/gtest.h>

namespace ca2 {
namespace {

TEST(RimPolygon, MomentsOfABoxAndOfATriangle) {
  RimPolygon polygon(0.5, 1);
  const auto box = polygon.moments();
  EXPECT_NEAR((box.mean - Eigen::Vector2d(0.5, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((box.covariance - Eigen::Matrix2d::Identity() / 3).norm(), 0, 1e-12);
  // The lower left half: corners (-0.5, -0.5), (1.5, -0.5), (-0.5, 1.5).
  polygon.cut({1, 1}, 1);
  const auto triangle = polygon.moments();
  EXPECT_NEAR((triangle.mean - Eigen::Vector2d(1 / 6., 1 / 6.)).norm(), 0, 1e-12);
  Eigen::Matrix2d covariance;
  covariance << 2, -1, -1, 2;
  EXPECT_NEAR((triangle.covariance - 4 / 36. * covariance).norm(), 0, 1e-12);
}

TEST(RimPolygon, CutsLeaveWhatAllAllow) {
  RimPolygon polygon(0, 1);
  polygon.cut({0.5, 0.5}, 0.1);
  polygon.cut({-0.5, -0.5}, 0.1);  // the mean of the ends is within 0.1
  const auto moments = polygon.moments();
  const Eigen::Vector2d middle(0.5, 0.5);
  EXPECT_NEAR(std::sqrt(middle.dot(moments.covariance * middle)), 0.1 / std::sqrt(3), 0.01);
  polygon.cut({-1, 0}, -2);
  EXPECT_TRUE(polygon.empty());
}

}  // namespace
}  // namespace ca2
