/// Where a LiDAR's beams come from, read off its returns.
#include "core/solve/beam_center.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ca2 {
namespace {

/// Returns of rings from (0, 0, height) at 1 to 3 m, their ranges noisy.
std::vector<ViewSights> cones(double height) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<ViewSights> views(1);
  views[0].lidars.resize(1);
  LidarSight& sight = views[0].lidars[0].emplace_back();
  sight.plane = {Eigen::Vector3d(-1, 0, 0), 2};
  sight.center = {2, 0, 0};
  for (int i = 0; i < 2000; ++i) {
    const double elevation = 0.02 * (i % 16 - 8), azimuth = 0.2 * unit(rng), range = 2 + unit(rng);
    const Eigen::Vector3d u(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            std::sin(elevation));
    sight.on_board.push_back(
        {(Eigen::Vector3d(0, 0, height) + range * u).cast<float>(), 0, static_cast<std::uint16_t>(i % 16)});
  }
  return views;
}

TEST(BeamCenter, IsFoundOnTheAxis) {
  EXPECT_NEAR(beam_center(cones(0.038), 0).z(), 0.038, 1e-4);
  EXPECT_TRUE(beam_center(cones(0), 0).isZero());
}

TEST(BeamCenter, IsLeftAloneWhereRingsDoNotTell) {
  std::vector<ViewSights> views = cones(0.038);
  for (BoardReturn& here : views[0].lidars[0][0].on_board) here.ring = BoardReturn::no_ring;
  EXPECT_TRUE(beam_center(views, 0).isZero());
  // Rings about another axis than z.
  views = cones(0.038);
  for (BoardReturn& here : views[0].lidars[0][0].on_board)
    here.point = Eigen::Vector3f(here.point.x(), here.point.z(), here.point.y() + 0.3f * here.point.x());
  EXPECT_TRUE(beam_center(views, 0).isZero());
}

TEST(BeamCenter, ThePlaneAndTheReturnsMoveTogether) {
  std::vector<ViewSights> views = cones(0.038);
  LidarSight& sight = views[0].lidars[0][0];
  const double before = sight.plane.distance(sight.on_board[0].point.cast<double>());
  move_origin(views, 0, {0, 0, 0.038});
  EXPECT_NEAR(sight.plane.distance(sight.on_board[0].point.cast<double>()), before, 1e-6);
  EXPECT_TRUE(beam_center(views, 0).isZero());
}

}  // namespace
}  // namespace ca2
