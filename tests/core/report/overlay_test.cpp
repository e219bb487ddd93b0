#include "core/report/overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

/// As PCD files of others have them, where a driver wrote its "no return" as a large number. What has no
/// pixel that an int can count is told by the sanitizers' build only.
TEST(Overlay, ReturnsBeyondAllMeasureAreNotDrawn) {
  const Image picture{8, 8, 1, 8, std::vector<std::uint8_t>(64, 100)};
  Scan wall;
  for (int i = -50; i <= 50; ++i) {
    for (int k = -20; k <= 20; ++k) wall.points.emplace_back(0.05f * float(i), 0.05f * float(k), 5.0f);
  }
  Scan scan = wall;
  const float far = 1e30f, infinite = std::numeric_limits<float>::infinity(), none = std::nanf("");
  for (const float value : {far, -far, infinite, none}) {
    scan.points.emplace_back(value, 1, 5);
    scan.points.emplace_back(1, value, 0.1f);
    scan.points.emplace_back(1, 1, value);
  }
  const Image drawn = draw_cloud(picture, {}, scan, Pose());
  const Image expected = draw_cloud(picture, {}, wall, Pose());
  EXPECT_GT(std::count(expected.bytes.begin(), expected.bytes.end(), 70), 100);
  EXPECT_EQ(drawn.bytes.size(), expected.bytes.size());
}

}  // namespace
}  // namespace ca2
