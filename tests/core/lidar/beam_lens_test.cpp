/// Where beams begin, against the manual's table of vertical corrections.
#include "core/lidar/beam_lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace ca2 {
namespace {

TEST(BeamLens, TheVlp16sIsThatOfItsManual) {
  const double radius = beam_lens_radius("VLP-16");
  for (const auto& [degrees, millimetres] :
       {std::pair{15, 11.2}, {13, 9.7}, {11, 8.1}, {9, 6.6}, {7, 5.1}, {5, 3.7}, {3, 2.2}, {1, 0.7}}) {
    EXPECT_NEAR(1e3 * radius * std::tan(degrees * M_PI / 180), millimetres, 0.1) << degrees;
  }
}

TEST(BeamLens, OfOthersNothingIsKnown) {
  EXPECT_EQ(beam_lens_radius("OS0-128"), 0);
  EXPECT_EQ(beam_lens_radius(""), 0);
}

}  // namespace
}  // namespace ca2
