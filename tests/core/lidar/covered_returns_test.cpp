#include "core/lidar/covered_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/features/lidar_sights.h"
#include "core/geometry/so3.h"
#include "core/lidar/board_candidate.h"

namespace ca2 {
namespace {

constexpr double width = 0.42, height = 0.297, wall = 3;  // m
constexpr double noise = 0.01;                            // m, of a range
constexpr int rings = 128, columns = 1024;

/// An A3 plate at 1 m, held by a fist that reaches 35 mm over its left side and stands 45 mm out of it.
struct HeldPlate {
  Pose T_lidar_board;  ///< z away from the sensor
  Plane plane;
  Scan scan;
  std::vector<char> on_hand, on_plate;  ///< by return

  HeldPlate(std::uint64_t seed, bool hand, double ring_offset) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Eigen::Matrix3d upright;
    upright << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // x to the right, y down, z ahead
    T_lidar_board = {upright * so3_exp({0.3 * normal(random), 0.3 * normal(random), 0.2}),
                     Eigen::Vector3d(1, 0.05, -0.05)};
    plane.normal = -T_lidar_board.R.col(2);
    plane.offset = -plane.normal.dot(T_lidar_board.t);
    const Eigen::Vector3d fist = T_lidar_board * Eigen::Vector3d(-width / 2, 0.02, -0.01);
    scan.rings = rings;
    scan.columns = columns;
    std::vector<double> offsets;
    for (int ring = 0; ring < rings; ++ring) offsets.push_back(ring_offset * normal(random));
    for (int column = 0; column < columns; ++column) {
      for (int ring = 0; ring < rings; ++ring) {
        const double e = (ring - 64) * 0.0122, a = std::numbers::pi * (1 - 2.0 * column / columns);
        const Eigen::Vector3d ray(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        double range = wall;
        const double toward = -plane.normal.dot(ray);
        const Eigen::Vector3d p = T_lidar_board.inverse() * (plane.offset / toward * ray);
        const bool plate = toward > 0 && std::abs(p.x()) < width / 2 && std::abs(p.y()) < height / 2;
        if (plate) range = plane.offset / toward;
        const double along = ray.dot(fist), off = fist.squaredNorm() - along * along;
        const double depth = 0.035 * 0.035 - off;
        const bool held = hand && depth > 0 && along > 0 && along - std::sqrt(depth) < range;
        if (held) range = along - std::sqrt(depth);
        range += noise * normal(random) + offsets[static_cast<std::size_t>(ring)];
        scan.points.push_back((range * ray).cast<float>());
        scan.ring.push_back(static_cast<std::uint16_t>(ring));
        scan.column.push_back(static_cast<std::uint32_t>(column));
        on_hand.push_back(held ? 1 : 0);
        on_plate.push_back(plate && !held ? 1 : 0);
      }
    }
  }
};

Board a3() {
  Board board;
  board.outline = Outline{width, height, {0, 0}};
  return board;
}

/// Distance of the plane through the returns from the plate's rim, m: the worst of its four corners.
double worst_at_corners(const Plane& plane, const HeldPlate& truth) {
  double worst = 0;
  for (const double sx : {-0.5, 0.5}) {
    for (const double sy : {-0.5, 0.5}) {
      const Eigen::Vector3d corner = truth.T_lidar_board * Eigen::Vector3d(sx * width, sy * height, 0);
      worst = std::max(worst, std::abs(plane.distance(corner)));
    }
  }
  return worst;
}

/// Half of the hand lies within the noise of the plate's ranges: what it pulls is what is kept of it.
TEST(CoveredReturns, AHandIsNoPartOfThePlate) {
  double worst = 0;
  std::size_t strangers = 0, kept = 0, plate = 0, hand = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const HeldPlate truth(seed, true, 0);
    const auto candidates = find_board_candidates(truth.scan, a3());
    ASSERT_FALSE(candidates.empty());
    const BoardCandidate& found = candidates.front();
    ASSERT_LT((found.T_lidar_board.t - truth.T_lidar_board.t).norm(), 0.04);
    worst = std::max(worst, worst_at_corners(found.plane, truth));
    for (std::size_t i = 0; i < truth.scan.size(); ++i) {
      hand += truth.on_hand[i];
      plate += truth.on_plate[i];
    }
    const LidarSight sight = sights_of(truth.scan, a3(), {&found, 1}).front();
    for (const auto* list : {&sight.on_board, &sight.around}) {
      for (const BoardReturn& here : *list) {
        const auto at = std::find(truth.scan.points.begin(), truth.scan.points.end(), here.point);
        const auto i = static_cast<std::size_t>(at - truth.scan.points.begin());
        strangers += truth.on_hand[i];
        kept += truth.on_plate[i];
      }
    }
    // Where the hand is, nothing is known of the rim.
    for (const EdgeCrossing& crossing : found.crossings) {
      const Eigen::Vector3d ray = crossing.inside.cast<double>();
      const Eigen::Vector3d p =
          truth.T_lidar_board.inverse() * (truth.plane.offset / -truth.plane.normal.dot(ray) * ray);
      const bool beside_hand = p.x() < 0 && std::abs(p.y() - 0.02) < 0.02;
      if (beside_hand && !crossing.across_rings) {
        EXPECT_LT(crossing.jump, 0) << p.transpose();
      }
    }
  }
  EXPECT_LT(worst, 0.0035);
  EXPECT_LT(static_cast<double>(strangers), 0.2 * static_cast<double>(hand));
  EXPECT_GT(static_cast<double>(kept), 0.93 * static_cast<double>(plate));
}

/// Neither noise nor lasers that err apart are taken for hands.
TEST(CoveredReturns, NothingLiesOnABarePlate) {
  for (const double ring_offset : {0.0, 0.01}) {
    std::size_t covered = 0, plate = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const HeldPlate truth(seed, false, ring_offset);
      const Projection projection = project_by_id(truth.scan);
      const RingImage image = make_ring_image(projection, truth.scan);
      const Eigen::Vector3d& centre = truth.T_lidar_board.t;
      const std::vector<PatchRay> rays =
          view_patch(image, {truth.plane, centre}, 0.3, 4 * noise, std::numeric_limits<std::size_t>::max());
      covered += find_covered_returns(projection, image, truth.plane, centre, rays, noise).size();
      plate += static_cast<std::size_t>(std::count(truth.on_plate.begin(), truth.on_plate.end(), 1));
    }
    EXPECT_LT(static_cast<double>(covered), 0.005 * static_cast<double>(plate)) << ring_offset;
  }
}

}  // namespace
}  // namespace ca2
