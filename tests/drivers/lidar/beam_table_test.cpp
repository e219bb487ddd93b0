#include "drivers/lidar/beam_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/profile.h"

namespace ca2 {
namespace {

constexpr double degree = std::numbers::pi / 180;

class EveryModel : public testing::TestWithParam<std::string> {};

std::vector<std::string> names_with_angles() {
  std::vector<std::string> names;
  for (const LidarModel& model : lidar_models()) {
    if (model.ouster() || !model.velodyne()->factory.lasers.empty()) names.push_back(model.name);
  }
  return names;
}

TEST_P(EveryModel, BeamsAreUnitRaysInElevationOrderWithinARevolution) {
  for (const double rate : {5.0, 10.0, 20.0}) {
    const Result<BeamTable> table = make_beam_table({GetParam(), {}, {}, rate, 0});
    ASSERT_TRUE(table) << table.error().text();
    ASSERT_EQ(table->rays.size(), static_cast<std::size_t>(table->rings) * table->columns);
    ASSERT_EQ(table->time.size(), table->rays.size());
    EXPECT_EQ(table->rate, rate);
    const bool top_first = GetParam().starts_with("OS");  // Scan's convention: Ouster's row 0 is at the top
    for (int column = 0; column < table->columns; column += 97) {
      for (int ring = 0; ring < table->rings; ++ring) {
        const BeamRay& ray = table->ray(ring, column);
        EXPECT_NEAR(ray.direction.norm(), 1, 1e-12);
        EXPECT_LT(ray.origin.norm(), 0.3);
        const double time = table->time[static_cast<std::size_t>(ring) * table->columns + column];
        EXPECT_GE(time, 0);
        EXPECT_LT(time, 1 / rate);
        if (ring == 0) continue;
        const double rise = ray.direction.z() - table->ray(ring - 1, column).direction.z();
        EXPECT_GT(top_first ? -rise : rise, 0) << "ring " << ring;
      }
    }
  }
}

TEST_P(EveryModel, TurnsClockwiseOncePerRevolution) {
  const Result<BeamTable> table = make_beam_table({GetParam(), {}, {}, 10, 0});
  ASSERT_TRUE(table);
  const int ring = table->rings / 2;
  double turned = 0;
  for (int column = 1; column < table->columns; ++column) {
    const auto& a = table->ray(ring, column - 1).direction;
    const auto& b = table->ray(ring, column).direction;
    const double step = std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
    EXPECT_LT(step, 0);  // clockwise seen from above
    turned -= step;
  }
  EXPECT_NEAR(turned / (360 * degree), 1, 2.5 / table->columns);
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryModel, testing::ValuesIn(names_with_angles()), [](const auto& param) {
  std::string name = param.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(BeamTable, Vlp16AnglesAndTimesAreTheManuals) {
  const Result<BeamTable> table = make_beam_table({"vlp16", {}, {}, 10, 0});
  ASSERT_TRUE(table);
  EXPECT_EQ(table->model, "VLP-16");
  EXPECT_EQ(table->columns, 1808);
  for (int ring = 0; ring < 16; ++ring) {
    EXPECT_NEAR(std::asin(table->ray(ring, 5).direction.z()) / degree, -15 + 2 * ring, 1e-9);
  }
  // Ring 8 (+1 degree) is laser 1: 2.304 us after laser 0, which looks along +y at azimuth 0.
  EXPECT_NEAR(table->ray(0, 0).direction.x(), 0, 1e-12);
  EXPECT_GT(table->ray(0, 0).direction.y(), 0.9);
  EXPECT_NEAR(table->time[8u * 1808 + 3], 3 * 55.296e-6 + 2.304e-6, 1e-12);
}

TEST(BeamTable, NominalOusterIsEvenAndDoesNotMeasureFromTheAxis) {
  const Result<BeamTable> table = make_beam_table({"OS0-128", {}, {}, 10, 2048});
  ASSERT_TRUE(table);
  EXPECT_EQ(table->columns, 2048);
  EXPECT_NEAR(std::asin(table->ray(0, 0).direction.z()) / degree, 45, 1e-9);
  EXPECT_NEAR(std::asin(table->ray(127, 0).direction.z()) / degree, -45, 1e-9);
  EXPECT_NEAR(table->time[1024], 0.05, 1e-12);
  // 27.67 mm along the beam's own measuring path: the sensor's axis is no beam's origin.
  EXPECT_GT(table->ray(64, 0).origin.head<2>().norm(), 0.5e-3);
}

TEST(BeamTable, RefusesWhatItCannotKnow) {
  const Result<BeamTable> unknown = make_beam_table({"VLP-17", {}, {}, 0, 0});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().text().find("VLP-16"), std::string::npos) << unknown.error().text();
  const Result<BeamTable> per_unit = make_beam_table({"HDL-64E", {}, {}, 0, 0});
  ASSERT_FALSE(per_unit);
  EXPECT_NE(per_unit.error().text().find("calibration"), std::string::npos);
  const Result<BeamTable> absent = make_beam_table({"", "/does/not/exist.json", {}, 0, 0});
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::io);
}

TEST(OusterProfile, FieldsLieInsideTheirPixel) {
  for (const OusterProfile& profile : ouster_profiles()) {
    for (const OusterField& field :
         {profile.range[0], profile.range[1], profile.reflectivity[0], profile.reflectivity[1],
          profile.signal[0], profile.signal[1], profile.near_ir}) {
      EXPECT_LE(field.bit + field.width, 8 * profile.pixel_bytes) << profile.name;
    }
    EXPECT_TRUE(profile.range[0].present());
  }
}

}  // namespace
}  // namespace ca2
