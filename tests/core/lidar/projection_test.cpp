#include "core/lidar/projection.h"

#include <gtest/gtest.h>

#include <numbers>

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "tests/support/lidar_scene.h"

namespace ca2 {
namespace {

using test::make_scene;
using test::ScanForm;
using test::Scene;
using test::SceneSensor;
using test::SceneSetup;

std::size_t good_returns(const Scan& scan) {
  std::size_t good = 0;
  for (const auto& p : scan.points) good += p.allFinite() && p.norm() > 0.01f;
  return good;
}

/// Largest angle (rad) by which a return lies beside the azimuth of its column.
double worst_azimuth(const Projection& projection, const Scan& scan) {
  double worst = 0;
  for (int ring = 0; ring < projection.rings; ++ring) {
    for (int column = 0; column < projection.columns; ++column) {
      const double azimuth = std::numbers::pi - column * projection.column_angle();
      for (const std::uint32_t i : projection.cell(ring, column)) {
        const double d = std::atan2(scan.points[i].y(), scan.points[i].x()) - azimuth;
        worst = std::max(worst, std::abs(std::remainder(d, 2 * std::numbers::pi)));
      }
    }
  }
  return worst;
}

TEST(Projection, every_return_has_one_cell_in_every_form) {
  for (const auto sensor : {&SceneSensor::vlp16, &SceneSensor::os0_128, &SceneSensor::hdl64e}) {
    for (const ScanForm form :
         {ScanForm::full, ScanForm::nan_grid, ScanForm::rings, ScanForm::bare, ScanForm::shuffled}) {
      const Scene scene = make_scene(sensor(), {0.9, 0.7, 2, 4, 0.5, false}, form, 5);
      const Projection projection = project_by_id(scene.scan);
      std::vector<std::uint32_t> placed;
      for (std::size_t cell = 0; cell < projection.range.size(); ++cell) {
        const auto returns = projection.cell(cell);
        EXPECT_EQ(projection.range[cell] > 0, !returns.empty());
        placed.insert(placed.end(), returns.begin(), returns.end());
      }
      EXPECT_EQ(placed.size(), good_returns(scene.scan));
      EXPECT_EQ(std::set<std::uint32_t>(placed.begin(), placed.end()).size(), placed.size());
      EXPECT_TRUE(projection.beams);
      EXPECT_EQ(projection.rings, static_cast<int>(sensor().elevation.size()));
      EXPECT_NEAR(projection.columns, sensor().columns, 0.02 * sensor().columns);
      // A column and the constant part of a ring's offset within it.
      EXPECT_LT(worst_azimuth(projection, scene.scan), 1.6 * projection.column_angle());
    }
  }
}

TEST(Projection, cones_are_the_beams) {
  const SceneSensor sensor = SceneSensor::hdl64e();
  const Scene scene = make_scene(sensor, {0.9, 0.7, 2, 4, 0.5, true}, ScanForm::full, 9);
  const Projection projection = project_by_id(scene.scan);
  for (std::size_t ring = 0; ring < sensor.elevation.size(); ++ring) {
    EXPECT_NEAR(projection.slope[ring], std::tan(sensor.elevation[ring]), 0.02);
    for (const double rho : {3.0, 6.0}) {
      EXPECT_NEAR(projection.height[ring] + rho * projection.slope[ring],
                  sensor.lift[ring] + rho * std::tan(sensor.elevation[ring]), 0.02);
    }
  }
}

TEST(Projection, rings_of_unorganised_points_are_found_by_elevation) {
  Scene scene = make_scene(SceneSensor::vlp16(), {0.9, 0.7, 2, 4, 0.5, true}, ScanForm::shuffled, 4);
  const std::vector<std::uint16_t> truth = scene.scan.ring;
  scene.scan.ring.clear();
  const Projection projection = project_by_id(scene.scan);
  ASSERT_EQ(projection.rings, 16);
  ASSERT_TRUE(projection.beams);
  for (int ring = 0; ring < 16; ++ring) {
    for (int column = 0; column < projection.columns; ++column) {
      for (const std::uint32_t i : projection.cell(ring, column)) ASSERT_EQ(truth[i], ring);
    }
  }
}

/// Points alone, in an order that says nothing, of those that came back: what is left is that all beams begin
/// on one circle.
TEST(Projection, rings_are_found_of_beams_that_begin_on_a_circle_about_the_axis) {
  const SceneSensor sensor = SceneSensor::os0_128();
  for (const std::uint64_t seed : {4u, 5u, 6u}) {
    Scan scan = make_scene(sensor, {0.42, 0.297, 0.5, 1.3, 0.5, true}, ScanForm::shuffled, seed).scan;
    const std::vector<std::uint16_t> truth = std::exchange(scan.ring, {});
    scan.column.clear();
    scan.rings = scan.columns = 0;
    const Projection projection = project_by_id(scan);
    ASSERT_TRUE(projection.beams);
    ASSERT_EQ(projection.rings, 128);
    ASSERT_TRUE(projection.found_ring);
    const std::vector<std::uint16_t>& found = *projection.found_ring;
    ASSERT_EQ(found.size(), scan.size());
    std::size_t right = 0;
    for (std::size_t i = 0; i < scan.size(); ++i) right += found[i] == 127 - truth[i];
    EXPECT_GT(right, 0.99 * static_cast<double>(good_returns(scan)));
    for (std::size_t ring = 0; ring < 128; ++ring) {
      const double slope = std::tan(sensor.elevation[127 - ring]);
      EXPECT_NEAR(projection.height[ring], sensor.lift[ring] - sensor.radius * slope, 2e-3) << ring;
    }
  }
}

TEST(Projection, wild_ids_are_not_believed) {
  Scene scene = make_scene(SceneSensor::vlp16(), {0.9, 0.7, 2, 4, 0.5, false}, ScanForm::full, 4);
  scene.scan.ring[100] = 65535;  // a damaged file must not ask for 65536 rings of memory
  scene.scan.columns = 2000000000;
  const Projection projection = project_by_id(scene.scan);
  EXPECT_LE(projection.rings, 1024);
  EXPECT_LE(projection.columns, 8192);
}

TEST(Projection, images_show_the_nearest_return) {
  Scan scan;
  scan.points = {{3, 0, 0.1f}, {2, 0, 0.1f}, {0, 5, 0.1f}};
  scan.intensity = {10, 20, 30};
  scan.ring = {0, 0, 0};
  const Projection projection = project_by_id(scan);
  const std::vector<float> intensity = intensity_image(projection, scan);
  std::multiset<float> bright, near;
  for (std::size_t i = 0; i < intensity.size(); ++i) {
    if (projection.range[i] > 0) bright.insert(intensity[i]), near.insert(std::round(projection.range[i]));
  }
  EXPECT_EQ(bright, (std::multiset<float>{20, 30}));
  EXPECT_EQ(near, (std::multiset<float>{2, 5}));
}

/// A board outdoors is all that a ring sees, and its returns are hardly nearer or farther than each other.
TEST(Projection, a_short_piece_of_a_ring_tells_where_its_beams_begin) {
  constexpr double begins = 0.038, climb = 0.1;  // m; of the beam
  Scan scan;
  scan.rings = 2;
  scan.columns = 1024;
  for (int k = 0; k < 40; ++k) {
    const double azimuth = 0.1 - k * 2 * std::numbers::pi / 1024;
    for (int ring = 0; ring < 2; ++ring) {
      const double across = 1.2 + 0.002 * k + (k % 2 == 0 ? 0.01 : -0.01);
      scan.points.emplace_back(Eigen::Vector3d(across * std::cos(azimuth), across * std::sin(azimuth),
                                               begins + (climb + 0.01 * ring) * across)
                                   .cast<float>());
      scan.ring.push_back(static_cast<std::uint16_t>(ring));
      scan.column.push_back(static_cast<std::uint32_t>(496 + k));
    }
  }
  const Projection projection = project_by_id(scan);
  ASSERT_TRUE(projection.beams);
  for (std::size_t ring = 0; ring < 2; ++ring) EXPECT_NEAR(projection.height[ring], begins, 0.001);
}

}  // namespace
}  // namespace ca2
