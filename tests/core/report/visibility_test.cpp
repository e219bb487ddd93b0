#include "core/report/visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace ca2 {
namespace {

/// Rays of a LiDAR every `spacing`; where each meets a wall 6 m ahead.
std::vector<Eigen::Vector3d> rays(double spacing) {
  std::vector<Eigen::Vector3d> list;
  for (double v = -0.3; v <= 0.3; v += spacing) {
    for (double u = -0.4; u <= 0.4; u += spacing) list.emplace_back(u, v, 1);
  }
  return list;
}

TEST(Visibility, AWallBehindAPlateIsHiddenAndBesideItIsNot) {
  constexpr double spacing = 0.01;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<Eigen::Vector3d> points;
  std::set<std::uint32_t> wall_behind, others;
  // The LiDAR that took the points sat elsewhere: the viewer sees both the plate at 2 m and the wall behind
  // it.
  for (const Eigen::Vector3d& ray : rays(spacing)) {
    const bool inside = std::abs(ray.x()) < 0.15 && std::abs(ray.y()) < 0.1;
    if (inside) {
      others.insert(static_cast<std::uint32_t>(points.size()));
      points.push_back(ray * (2 + noise(random)));
    }
    (inside ? wall_behind : others).insert(static_cast<std::uint32_t>(points.size()));
    points.push_back(Eigen::Vector3d(ray.x() + 0.3 * spacing, ray.y(), 1) * (6 + noise(random)));
  }
  int hidden = 0, shown = 0;
  for (const std::uint32_t i : visible_from_origin(points, spacing)) {
    hidden += static_cast<int>(wall_behind.count(i));
    shown += static_cast<int>(others.count(i));
  }
  // Along the plate's rim a row of either may be wrong.
  EXPECT_LT(hidden, 0.15 * static_cast<double>(wall_behind.size()));
  EXPECT_GT(shown, 0.9 * static_cast<double>(others.size()));
}

TEST(Visibility, OnlyTheNearHalfOfASphere) {
  std::vector<Eigen::Vector3d> points;
  constexpr int count = 3000;
  for (int i = 0; i < count; ++i) {  // Fibonacci's: even
    const double z = 1 - (2.0 * i + 1) / count, angle = i * M_PI * (3 - std::sqrt(5));
    const double r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), 4 + z);
  }
  int near = 0, far = 0;
  for (const std::uint32_t i : visible_from_origin(points, 0.02)) (points[i].z() < 3.75 ? near : far)++;
  int near_all = 0;
  for (const auto& p : points) near_all += p.z() < 3.7;
  EXPECT_GT(near, 0.95 * near_all);
  EXPECT_LT(far, 0.15 * (count - near_all));
}

TEST(Visibility, AnyCloudIsSurvived) {
  EXPECT_TRUE(visible_from_origin({}, 0.01).empty());
  EXPECT_EQ(visible_from_origin({{0, 0, 1}}, 0.01).size(), 1u);
  EXPECT_EQ(visible_from_origin({{0, 0, 0}, {0, 0, 1}}, 0.01).size(), 1u);
  // All in one direction, and all the same point.
  EXPECT_FALSE(visible_from_origin(std::vector<Eigen::Vector3d>(50, {1, 2, 3}), 0.01).empty());
  std::vector<Eigen::Vector3d> line;
  for (int i = 1; i < 50; ++i) line.emplace_back(0.1 * i, 0, 1);
  EXPECT_FALSE(visible_from_origin(line, 0.01).empty());
}

}  // namespace
}  // namespace ca2
