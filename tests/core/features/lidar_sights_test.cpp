/// What the estimator is given of a scan.
#include "core/features/lidar_sights.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "core/board/board.h"
#include "tests/support/lidar_scene.h"

namespace ca2 {
namespace {

using test::make_scene;
using test::ScanForm;
using test::SceneSensor;

/// Where on the axis the rays of the best sight's returns begin, m, by point.
std::map<std::tuple<float, float, float>, float> heights_of(const Scan& scan) {
  Board board;
  board.outline = Outline{0.42, 0.297, {0, 0}};
  std::map<std::tuple<float, float, float>, float> heights;
  const std::vector<LidarSight> sights = find_sights(scan, board);
  if (sights.empty()) return heights;
  for (const BoardReturn& one : sights.front().on_board)
    heights[{one.point.x(), one.point.y(), one.point.z()}] = one.height;
  return heights;
}

/// An OS0's beams begin 28 mm before its axis and 36 mm above its origin: points alone show it as points with
/// their rings do.
TEST(LidarSights, RaysBeginWhereFoundRingsBegin) {
  for (const std::uint64_t seed : {2u, 5u}) {
    Scan scan =
        make_scene(SceneSensor::os0_128(), {0.42, 0.297, 0.6, 1.2, 0.5, true}, ScanForm::shuffled, seed).scan;
    const auto named = heights_of(scan);
    scan.ring.clear();
    scan.rings = 0;
    const auto bare = heights_of(scan);
    ASSERT_GT(named.size(), 200u);
    std::size_t both = 0;
    for (const auto& [point, height] : bare) {
      const auto at = named.find(point);
      if (at == named.end()) continue;
      ++both;
      EXPECT_NEAR(height, at->second, 1e-3);
      EXPECT_GT(height, 0.015);
    }
    EXPECT_GT(both, named.size() * 9 / 10);
  }
}

}  // namespace
}  // namespace ca2
