// What every camera model of the registry must obey; a new model joins with a line in examples.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/core/camera/examples.h"

namespace ca2 {
namespace {

using test::describe;
using test::example_cameras;

/// The same azimuth, `theta` off the axis.
Eigen::Vector3d direction(double theta, double azimuth) {
  return {std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta)};
}

TEST(Models, EveryModelHasExamplesAndIsFound) {
  for (const CameraModel* model : camera_models()) {
    EXPECT_EQ(find_camera_model(model->name()), model);
    const auto cameras = example_cameras();
    EXPECT_TRUE(std::any_of(cameras.begin(), cameras.end(), [&](const Camera& c) {
      return c.model == model;
    })) << model->name();
    EXPECT_LE(model->parameter_names().size(), static_cast<std::size_t>(max_camera_parameters));
    const std::vector<std::string_view> first(model->parameter_names().begin(),
                                              model->parameter_names().begin() + 4);
    EXPECT_EQ(first, (std::vector<std::string_view>{"fx", "fy", "cx", "cy"}));
  }
  EXPECT_EQ(find_camera_model("pinhole"), nullptr);
}

TEST(Models, ProjectInvertsUnprojectAcrossThePicture) {
  std::mt19937_64 rng(1);
  for (const Camera& camera : example_cameras()) {
    int seen = 0;
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d pixel = test::random_pixel(camera, rng);
      const auto ray = camera.unproject(pixel);
      if (!ray) continue;
      ++seen;
      EXPECT_NEAR(ray->norm(), 1, 1e-14);
      const auto again = camera.project(*ray * 3.7);
      ASSERT_TRUE(again) << describe(camera) << " " << pixel.transpose();
      EXPECT_LT((*again - pixel).norm(), 1e-9) << describe(camera) << " " << pixel.transpose();
    }
    // Image circles and lenses that fold leave a part of some pictures blind.
    EXPECT_GT(seen, 1400) << describe(camera);
  }
}

TEST(Models, UnprojectInvertsProjectOnTheWholeDomain) {
  std::mt19937_64 rng(2);
  for (const Camera& camera : example_cameras()) {
    int seen = 0;
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Vector3d p = test::random_direction(rng);
      const auto pixel = camera.project(p);
      const double theta = std::atan2(p.head<2>().norm(), p.z());
      // At the very rim of the domain the picture stands still while the ray turns: stay 0.5 % away.
      const Eigen::Vector3d outer = direction(theta * 1.005, std::atan2(p.y(), p.x()));
      if (!pixel || !camera.project(outer)) continue;
      // Rays near 90 degrees reach pinhole pixels at 1e6 and more, where a pixel's own rounding matters.
      if (pixel->norm() > 1e5) continue;
      ++seen;
      const auto ray = camera.unproject(*pixel);
      ASSERT_TRUE(ray) << describe(camera) << " " << p.transpose();
      EXPECT_LT((*ray - p).norm(), 1e-9) << describe(camera) << " " << p.transpose();
    }
    EXPECT_GT(seen, 100) << describe(camera);
  }
}

TEST(Models, JacobiansAreTheDerivatives) {
  std::mt19937_64 rng(3);
  for (const Camera& camera : example_cameras()) {
    for (int i = 0; i < 200; ++i) {
      const auto ray = camera.unproject(test::random_pixel(camera, rng));
      if (!ray) continue;
      const Eigen::Vector3d p = *ray * 2.5;
      ProjectionJacobian jacobian;
      const auto pixel = camera.project(p, &jacobian);
      ASSERT_TRUE(pixel);
      EXPECT_EQ((*pixel - *camera.project(p)).norm(), 0);
      ASSERT_EQ(jacobian.parameters.cols(), camera.parameters.size());
      const double h = 1e-6;
      for (int j = 0; j < 3; ++j) {
        const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(j);
        const auto plus = camera.project(p + d), minus = camera.project(p - d);
        if (!plus || !minus) continue;
        const Eigen::Vector2d numeric = (*plus - *minus) / (2 * h);
        EXPECT_LT((numeric - jacobian.point.col(j)).norm(), 1e-6 * (100 + jacobian.point.norm()))
            << describe(camera) << " point " << j;
      }
      for (Eigen::Index j = 0; j < camera.parameters.size(); ++j) {
        Camera plus = camera, minus = camera;
        const double step = h * std::max(1.0, std::abs(camera.parameters[j]));
        plus.parameters[j] += step;
        minus.parameters[j] -= step;
        const auto a = plus.project(p), b = minus.project(p);
        if (!a || !b) continue;
        const Eigen::Vector2d numeric = (*a - *b) / (2 * step);
        EXPECT_LT((numeric - jacobian.parameters.col(j)).norm(), 1e-6 * (100 + numeric.norm()))
            << describe(camera) << " parameter " << camera.model->parameter_names()[j];
      }
    }
  }
}

TEST(Models, TheAxisIsASmoothPlace) {
  for (const Camera& camera : example_cameras()) {
    ProjectionJacobian on_axis, beside;
    const auto a = camera.project({0, 0, 2}, &on_axis);
    const auto b = camera.project({1e-9, -1e-9, 2}, &beside);
    ASSERT_TRUE(a && b) << describe(camera);
    EXPECT_LT((*a - camera.parameters.segment<2>(2)).norm(), 1e-12);
    EXPECT_LT((on_axis.point - beside.point).norm(), 1e-5) << describe(camera);
    const auto ray = camera.unproject(camera.parameters.segment<2>(2));
    ASSERT_TRUE(ray);
    EXPECT_LT((*ray - Eigen::Vector3d::UnitZ()).norm(), 1e-12) << describe(camera);
  }
}

TEST(Models, TheDomainIsOnePieceAndThePictureGrowsOutwards) {
  for (const Camera& camera : example_cameras()) {
    const Eigen::Vector2d f = camera.parameters.head<2>(), c = camera.parameters.segment<2>(2);
    for (double azimuth = 0.1; azimuth < 6.3; azimuth += 0.37) {
      const Eigen::Vector2d n(std::cos(azimuth), std::sin(azimuth));
      double before = -1;
      bool ended = false;
      for (double theta = 1e-4; theta < M_PI; theta += 1e-3) {
        const auto pixel = camera.project(direction(theta, azimuth));
        EXPECT_FALSE(ended && pixel) << describe(camera) << " comes back at " << theta;
        ended = ended || !pixel;
        if (!pixel) continue;
        const double radius = (*pixel - c).cwiseQuotient(f).dot(n);
        EXPECT_GT(radius, before) << describe(camera) << " folds at " << theta;
        before = radius;
      }
      EXPECT_GT(before, 0.3) << describe(camera);
    }
  }
}

TEST(Models, PixelsBeyondTheDomainHaveNoRay) {
  // Barrel distortion r - 0.45 r^3 folds at r = 0.861 with r' = 0.574.
  const Camera barrel = test::make_camera("pinhole_radtan", 640, 480, {500, 500, 320, 240, -0.45, 0, 0, 0});
  const double fold = std::sqrt(1 / (3 * 0.45)), rim = fold * 2 / 3;
  EXPECT_TRUE(barrel.project({fold - 1e-6, 0, 1}));
  EXPECT_FALSE(barrel.project({fold + 1e-6, 0, 1}));
  EXPECT_FALSE(barrel.project({2 * fold, 0, 1}));
  EXPECT_TRUE(barrel.unproject({320 + 500 * (rim - 1e-9), 240}));
  EXPECT_FALSE(barrel.unproject({320 + 500 * (rim + 1e-9), 240}));

  // theta - 0.1 theta^3 folds at theta = 1.826, beyond 90 degrees, with theta_d = 1.217.
  const Camera fish = test::make_camera("kannala_brandt", 800, 800, {300, 300, 400, 400, -0.1, 0, 0, 0});
  const double turn = std::sqrt(1 / 0.3);
  EXPECT_TRUE(fish.project(direction(turn - 1e-6, 1)));
  EXPECT_FALSE(fish.project(direction(turn + 1e-6, 1)));
  EXPECT_TRUE(fish.unproject({400 + 300 * (turn * 2 / 3 - 1e-9), 400}));
  EXPECT_FALSE(fish.unproject({400 + 300 * (turn * 2 / 3 + 1e-9), 400}));

  // The double sphere's picture ends at r^2 = 1 / (2 alpha - 1) (equation 47 of the paper).
  const Camera sphere = test::make_camera("double_sphere", 512, 512, {157, 157, 254, 256, -0.18, 0.59});
  const double r = 157 / std::sqrt(2 * 0.59 - 1);
  EXPECT_TRUE(sphere.unproject({254 + r - 1e-6, 256}));
  EXPECT_FALSE(sphere.unproject({254 + r + 1e-6, 256}));
}

TEST(Models, AFoldThatEndsAgainIsStillAFold) {
  // r' = r (1 - 2 r^2 + 1.5 r^4) falls between r = 0.487 and 0.751 only: beyond, one pixel has several rays.
  const Camera camera = test::make_camera("pinhole_radtan", 640, 480, {500, 500, 320, 240, -2, 1.5, 0, 0});
  EXPECT_TRUE(camera.project({0.48, 0, 1}));
  for (const double r : {0.49, 0.7, 0.76, 0.8, 1.0, 3.0}) EXPECT_FALSE(camera.project({r, 0, 1})) << r;
}

TEST(Models, APoleOfTheRationalModelEndsItsDomain) {
  // The denominator 1 - r^2 vanishes at r = 1.
  const Camera camera =
      test::make_camera("pinhole_rational", 640, 480, {500, 500, 320, 240, 0, 0, 0, 0, 0, -1, 0, 0});
  EXPECT_TRUE(camera.project({0.99, 0, 1}));
  EXPECT_FALSE(camera.project({1.01, 0, 1}));
  EXPECT_FALSE(camera.project({5, 0, 1}));
}

TEST(Models, WideModelsSeeBehindThemselves) {
  const Camera t265 =
      test::make_camera("kannala_brandt", 848, 800, {286, 287, 418, 402, -0.0056, 0.041, -0.038, 0.0062});
  const Camera equidistant = test::make_camera("kannala_brandt", 800, 800, {200, 200, 400, 400, 0, 0, 0, 0});
  const double behind = 110 * M_PI / 180;
  EXPECT_TRUE(t265.project(direction(behind, 0.3)));
  EXPECT_TRUE(equidistant.project(direction(behind, 0.3)));
  const auto pixel = equidistant.project(direction(behind, 0));
  EXPECT_NEAR(pixel->x(), 400 + 200 * behind, 1e-9);
  EXPECT_FALSE(equidistant.project({0, 0, -1})) << "straight back has no azimuth";
}

TEST(Models, PointsThatAreNoPointsAreNotProjected) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Camera& camera : example_cameras()) {
    EXPECT_FALSE(camera.project({0, 0, 0})) << describe(camera);
    EXPECT_FALSE(camera.project({nan, 0, 1})) << describe(camera);
    EXPECT_FALSE(camera.project({0, 0, nan})) << describe(camera);
    EXPECT_FALSE(camera.project({infinity, infinity, infinity})) << describe(camera);
    EXPECT_FALSE(camera.unproject({nan, 0})) << describe(camera);
    EXPECT_FALSE(camera.unproject({infinity, 0})) << describe(camera);
  }
}

TEST(Models, InvalidParametersAreNamed) {
  for (const Camera& camera : example_cameras()) {
    EXPECT_FALSE(camera.model->invalid(camera.parameters)) << describe(camera);
    const auto names = camera.model->parameter_names();
    for (Eigen::Index i = 0; i < camera.parameters.size(); ++i) {
      CameraParameters bad = camera.parameters;
      for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        bad[i] = value;
        const auto reason = camera.model->invalid(bad);
        ASSERT_TRUE(reason);
        EXPECT_NE(reason->find(names[i]), std::string::npos) << *reason;
      }
    }
    for (int i = 0; i < 2; ++i) {
      for (const double value : {0.0, -500.0}) {
        CameraParameters bad = camera.parameters;
        bad[i] = value;
        EXPECT_TRUE(camera.model->invalid(bad));
      }
    }
    EXPECT_TRUE(camera.model->invalid(CameraParameters()));
    const auto least = static_cast<Eigen::Index>(names.size()) - camera.model->optional_parameters();
    EXPECT_TRUE(camera.model->invalid(CameraParameters(camera.parameters.head(least - 1))));
    if (names.size() < static_cast<std::size_t>(max_camera_parameters)) {
      CameraParameters longer = CameraParameters::Ones(static_cast<Eigen::Index>(names.size()) + 1);
      EXPECT_TRUE(camera.model->invalid(longer));
    }
  }
  const CameraModel* sphere = find_camera_model("double_sphere");
  for (const auto& [xi, alpha] : {std::pair{1.0, 0.5}, {-1.2, 0.5}, {0.0, -0.1}, {0.0, 1.1}}) {
    CameraParameters p(6);
    p << 300, 300, 320, 240, xi, alpha;
    EXPECT_TRUE(sphere->invalid(p)) << xi << " " << alpha;
  }
}

}  // namespace
}  // namespace ca2
