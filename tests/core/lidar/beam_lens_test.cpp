/// Where beams begin, against the manual's table of vertical corrections.
#include "core/lidar/beam_lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

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

TEST(BeamLens, OneNameIsWrittenInManyWays) {
  for (const char* name : {"vlp16", "VLP_16", "Vlp-16"}) EXPECT_GT(beam_lens_radius(name), 0) << name;
  EXPECT_EQ(beam_lens_radius("VLP-32C"), 0);
}

/// Elevations of `degrees`, a hundred returns of each.
std::vector<float> beams_at(const std::vector<double>& degrees, double noise = 0) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> error(0, 1);
  std::vector<float> elevations;
  for (const double degree : degrees) {
    for (int i = 0; i < 100; ++i)
      elevations.push_back(static_cast<float>((degree + noise * error(rng)) * M_PI / 180));
  }
  return elevations;
}

TEST(BeamLens, ALidarWithoutANameIsToldByItsBeams) {
  EXPECT_GT(beam_lens_radius(beams_at({-5, -3, -1, 1, 3})), 0);
  EXPECT_GT(beam_lens_radius(beams_at({-15, -7, 9, 15}, 0.03)), 0);
}

TEST(BeamLens, OtherBeamsAreOfOtherLidars) {
  EXPECT_EQ(beam_lens_radius(beams_at({-5, -3, -1})), 0) << "too few to tell";
  EXPECT_EQ(beam_lens_radius(beams_at({-5, -4, -3, -2, -1, 0, 1})), 0) << "every degree";
  EXPECT_EQ(beam_lens_radius(beams_at({-17, -15, -13, -11, -9, -7})), 0) << "one below";
  EXPECT_EQ(beam_lens_radius(beams_at({-6.67, -5.33, -4, -2.67, -1.33, 0})), 0) << "an HDL-32E's";
  EXPECT_EQ(beam_lens_radius(beams_at({-5.1, -3.1, -1.1, 0.9, 2.9})), 0) << "off by a tenth";
  EXPECT_EQ(beam_lens_radius(std::vector<float>{}), 0);
}

}  // namespace
}  // namespace ca2
