#include "core/lidar/edge_crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/so3.h"
#include "core/lidar/projection.h"

namespace ca2 {
namespace {

constexpr double kWidth = 0.8, kHeight = 0.6, kWall = 6;  // m
constexpr int kRings = 33, kColumns = 1024;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

double elevation(int ring) {
  return (ring - 16) * 0.0125;
}
double azimuth(int column) {
  return std::numbers::pi - 2 * std::numbers::pi * column / kColumns;
}

/// A plate before a round wall, seen without noise.
struct Stage {
  Pose T_lidar_board;  ///< z away from the sensor
  Plane plane;
  Scan scan;

  /// `turn`: of the plate in its plane, rad; `bearing`: where it stands, rad.
  explicit Stage(double turn = 0, double bearing = 0.4, double distance = 2.5) {
    Eigen::Matrix3d upright;
    upright << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // x to the right, y down, z ahead
    const Eigen::Matrix3d R_bearing = so3_exp({0, 0, bearing});
    T_lidar_board = {R_bearing * upright * so3_exp({0, 0, turn}),
                     distance * (R_bearing * Eigen::Vector3d::UnitX())};
    plane.normal = -T_lidar_board.R.col(2);
    plane.offset = -plane.normal.dot(T_lidar_board.t);
    scan.rings = kRings;
    scan.columns = kColumns;
    for (int column = 0; column < kColumns; ++column) {
      for (int ring = 0; ring < kRings; ++ring) {
        const double e = elevation(ring), a = azimuth(column);
        const Eigen::Vector3d ray(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        scan.points.push_back((on_plate(ray) ? hit(ray) : (kWall * ray).eval()).cast<float>());
        scan.ring.push_back(static_cast<std::uint16_t>(ring));
        scan.column.push_back(static_cast<std::uint32_t>(column));
      }
    }
  }

  Eigen::Vector3d hit(const Eigen::Vector3d& ray) const {
    const double toward = -plane.normal.dot(ray);
    return toward > 0 ? (plane.offset / toward * ray).eval() : Eigen::Vector3d::Constant(1e6).eval();
  }
  /// Outside (positive) or inside the rim, m.
  double beyond_rim(const Eigen::Vector3d& ray) const {
    const Eigen::Vector3d p = T_lidar_board.inverse() * hit(ray);
    return std::max(std::abs(p.x()) - kWidth / 2, std::abs(p.y()) - kHeight / 2);
  }
  bool on_plate(const Eigen::Vector3d& ray) const { return beyond_rim(ray) <= 0; }

  /// The returns whose place on the plate (m, from its centre) is in a box become something else.
  template <class Change>
  void change(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Change to) {
    for (Eigen::Vector3f& point : scan.points) {
      if (!point.allFinite()) continue;
      const Eigen::Vector3d p = T_lidar_board.inverse() * hit(point.cast<double>().normalized());
      if ((p.head<2>().array() >= low.array()).all() && (p.head<2>().array() <= high.array()).all())
        point = to(point);
    }
  }

  std::vector<EdgeCrossing> crossings() const {
    return find_edge_crossings(scan, project_by_id(scan), {plane, T_lidar_board, kWidth, kHeight, 0.01});
  }
  double x_on_plate(const EdgeCrossing& crossing) const {
    return (T_lidar_board.inverse() * hit(crossing.inside.cast<double>())).x();
  }
};

/// The rim lies between the two rays of every crossing.
void expect_rim_between(const Stage& stage, const std::vector<EdgeCrossing>& crossings) {
  for (const EdgeCrossing& crossing : crossings) {
    EXPECT_LT(stage.beyond_rim(crossing.inside.cast<double>()), 1e-5);
    EXPECT_GT(stage.beyond_rim(crossing.outside.cast<double>()), -1e-5);
  }
}

int along_rings(const std::vector<EdgeCrossing>& crossings) {
  return static_cast<int>(
      std::count_if(crossings.begin(), crossings.end(), [](const auto& c) { return !c.across_rings; }));
}

TEST(EdgeCrossings, every_ring_enters_and_leaves_the_plate) {
  const Stage stage;
  const std::vector<EdgeCrossing> crossings = stage.crossings();
  expect_rim_between(stage, crossings);
  int rings = 0;
  for (int ring = 0; ring < kRings; ++ring)
    rings += std::abs(2.5 * std::tan(elevation(ring))) < kHeight / 2 - 0.01;
  EXPECT_GE(along_rings(crossings), 2 * rings);
  EXPECT_LE(along_rings(crossings), 2 * (rings + 2));
  // Above and below it ends between two rings, over its whole width.
  const int across = static_cast<int>(crossings.size()) - along_rings(crossings);
  EXPECT_NEAR(across, 2 * kWidth / 2.5 * kColumns / (2 * std::numbers::pi), 8);
  for (const EdgeCrossing& crossing : crossings) EXPECT_NEAR(crossing.jump, kWall - 2.5, 0.2);
}

TEST(EdgeCrossings, a_turned_plate_has_corners_that_rings_graze) {
  const Stage stage(0.6);
  const std::vector<EdgeCrossing> crossings = stage.crossings();
  EXPECT_GT(along_rings(crossings), 20);
  expect_rim_between(stage, crossings);
}

TEST(EdgeCrossings, what_covers_a_side_tells_nothing_about_it) {
  Stage stage;
  // A hand before the right rim, in the middle third of its height.
  stage.change({kWidth / 2 - 0.03, -0.1}, {kWidth / 2 + 0.1, 0.1},
               [](const Eigen::Vector3f& p) { return (p.normalized() * 2.3f).eval(); });
  int covered = 0;
  for (const EdgeCrossing& crossing : stage.crossings()) {
    if (crossing.across_rings) continue;
    const bool right = stage.x_on_plate(crossing) > 0;
    const double y = 2.5 * std::tan(std::asin(static_cast<double>(crossing.inside.z())));
    if (right && std::abs(y) < 0.08) {
      EXPECT_LT(crossing.jump, 0);
      ++covered;
    } else if (!right) {
      EXPECT_GT(crossing.jump, 1);
    }
  }
  EXPECT_GE(covered, 4);
}

TEST(EdgeCrossings, a_wide_beam_moves_the_rim_by_a_column_and_no_more) {
  Stage stage;
  const std::size_t before = stage.crossings().size();
  // Rays that pass the left and right rim by less than half a column touch it and end on it.
  const double half_column = 0.5 * 2.5 * 2 * std::numbers::pi / kColumns;
  for (const double side : {-1.0, 1.0}) {
    const double from = side * kWidth / 2, to = side * (kWidth / 2 + half_column);
    stage.change({std::min(from, to), -kHeight / 2}, {std::max(from, to), kHeight / 2},
                 [&](const Eigen::Vector3f& p) {
                   return stage.hit(p.cast<double>().normalized()).cast<float>().eval();
                 });
  }
  const std::vector<EdgeCrossing> crossings = stage.crossings();
  EXPECT_NEAR(static_cast<double>(crossings.size()), static_cast<double>(before), 4);
  for (const EdgeCrossing& crossing : crossings) {
    EXPECT_LT(stage.beyond_rim(crossing.inside.cast<double>()), half_column + 1e-5);
    EXPECT_GT(stage.beyond_rim(crossing.outside.cast<double>()), 0);
  }
}

TEST(EdgeCrossings, a_hole_in_the_middle_is_no_rim) {
  const std::size_t whole = Stage().crossings().size();
  Stage stage;
  const auto nothing = [](const Eigen::Vector3f&) { return Eigen::Vector3f::Constant(kNaN).eval(); };
  stage.change({-0.1, -0.1}, {0.1, 0.1}, nothing);
  const std::vector<EdgeCrossing> crossings = stage.crossings();
  EXPECT_EQ(crossings.size(), whole);
  expect_rim_between(stage, crossings);
}

TEST(EdgeCrossings, the_last_return_on_the_plate_got_lost) {
  Stage stage;
  const int rings = along_rings(stage.crossings());
  // Of every ring the last ray that ended on the plate, towards +x.
  const double last = kWidth / 2 - stage.T_lidar_board.t.norm() * 2 * std::numbers::pi / kColumns;
  stage.change({last, -1}, {kWidth / 2, 1}, [](auto) { return Eigen::Vector3f::Constant(kNaN); });
  const auto crossings = stage.crossings();
  EXPECT_EQ(along_rings(crossings), rings);
  expect_rim_between(stage, crossings);
}

TEST(EdgeCrossings, nothing_comes_back_from_beside_the_plate) {
  Stage stage;
  for (Eigen::Vector3f& point : stage.scan.points) {
    if (point.norm() > kWall - 1) point.setConstant(kNaN);
  }
  const std::vector<EdgeCrossing> crossings = stage.crossings();
  EXPECT_GT(along_rings(crossings), 30);
  expect_rim_between(stage, crossings);
  for (const EdgeCrossing& crossing : crossings) EXPECT_TRUE(std::isinf(crossing.jump));
}

TEST(EdgeCrossings, the_seam_of_the_columns_is_no_rim) {
  // Half a column beside a whole number of them, so that all rays are as they are away from the seam.
  const Stage away(0, 0), on_seam(0, std::numbers::pi);
  const std::vector<EdgeCrossing> a = away.crossings(), b = on_seam.crossings();
  EXPECT_GT(a.size(), 60u);
  EXPECT_EQ(a.size(), b.size());
  expect_rim_between(on_seam, b);
}

TEST(EdgeCrossings, none_where_rings_are_not_known_or_the_plate_is_all_around) {
  Stage stage;
  Projection projection = project_by_id(stage.scan);
  const RimSearch search{stage.plane, stage.T_lidar_board, kWidth, kHeight, 0.01};
  EXPECT_FALSE(find_edge_crossings(stage.scan, projection, search).empty());
  projection.beams = false;
  EXPECT_TRUE(find_edge_crossings(stage.scan, projection, search).empty());
  const Stage close(0, 0, 0.3);
  EXPECT_TRUE(close.crossings().empty());
}

}  // namespace
}  // namespace ca2
