/// A beam half on a plate and half on the wall behind it: where it stops returning the plate.
#include "tools/sim/beam_echo.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {
namespace {

constexpr double range = 2, half_width = 0.2, divergence = 0.006;  // m, m, rad

/// By how many half beams the axis is past the plate's side when the wall's echo becomes the stronger, with
/// the side turned by `roll` [rad] about the axis and the wall `behind` times as far as the plate.
double rim(double roll, double behind) {
  Scene scene;
  Solid plate;
  plate.shape = Shape::plate;
  plate.T_rig_solid.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  plate.T_rig_solid.R = plate.T_rig_solid.R * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  plate.T_rig_solid.t = {range, 0, 0};
  plate.plate.outline = {2 * half_width, 2 * half_width, Eigen::Vector2d::Zero()};
  Solid wall;
  wall.shape = Shape::box;
  wall.size = {0.1, 30, 30};
  wall.T_rig_solid.t = {behind * range + 0.1, 0, 0};
  plate.material.contrast = wall.material.contrast = 0;
  const int first = scene.add(plate);
  scene.add(wall);
  LidarNoise noise;
  noise.divergence = divergence;
  const Eigen::Vector3d side = scene.solids[static_cast<std::size_t>(first)].T_rig_solid.R.col(0);
  const double edge = std::atan(half_width / range);
  double inside = edge - divergence, outside = edge + divergence;
  while (outside - inside > 1e-7) {
    const double angle = 0.5 * (inside + outside);
    const Eigen::Vector3d direction = std::cos(angle) * Eigen::Vector3d::UnitX() + std::sin(angle) * side;
    const SolidHit axis = scene.cast(Eigen::Vector3d::Zero(), direction);
    const auto echo = cone_echo(scene, noise, axis, Eigen::Vector3d::Zero(), direction);
    (echo && echo->range < 1.2 * range ? inside : outside) = angle;
  }
  return (inside - edge) / (0.5 * divergence);
}

/// So many radii from the middle of an evenly lit disc a straight line leaves this share of it beyond.
double offset_for(double share) {
  double low = -1, high = 1;
  while (high - low > 1e-9) {
    const double offset = 0.5 * (low + high);
    const double beyond = (std::acos(offset) - offset * std::sqrt(1 - offset * offset)) / std::numbers::pi;
    (beyond > share ? low : high) = offset;
  }
  return low;
}

TEST(BeamEcho, TheStrongerOfTwoEchoesDecidesWhereARimIs) {
  for (const double behind : {1.3, 2.0, 3.0}) {
    // Where the shares of the beam on the plate and on the wall answer alike.
    const double expected = offset_for(1 / (1 + behind * behind));
    for (int turn = 0; turn < 8; ++turn)
      EXPECT_NEAR(rim(turn * std::numbers::pi / 16, behind), expected, 0.07) << behind << " " << turn;
  }
}

TEST(BeamEcho, RimsLieFurtherOutBeforeFartherWalls) {
  EXPECT_GT(rim(0.1, 2), rim(0.1, 1.3) + 0.1);
  EXPECT_GT(rim(0.1, 4), rim(0.1, 2) + 0.1);
}

}  // namespace
}  // namespace ca2
