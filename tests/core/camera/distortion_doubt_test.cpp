#include "core/camera/distortion_doubt.h"

#include <gtest/gtest.h>

#include "tests/core/camera/examples.h"

namespace ca2 {
namespace {

using test::make_camera;

/// The doubt about a usual camera with these coefficients.
std::string doubt_of(const char* model, std::vector<double> coefficients) {
  coefficients.insert(coefficients.begin(), {520, 520, 320, 240});
  return distortion_doubt(make_camera(model, 640, 480, coefficients)).value_or("none");
}

TEST(DistortionDoubt, AFoldInsideThePictureIsToldWithAngleAndCoefficient) {
  // 1 + 3 k1 r^2 = 0 at r = 0.408: 22.2 degrees, 0.408 (1 - 2 / 6) 520 = 141.5 px.
  EXPECT_EQ(doubt_of("pinhole_radtan", {-2, 0, 0, 0}),
            "the distortion folds back 22 degrees off the axis, 142 px from the principal point, inside the "
            "picture "
            "(k1 = -2)");
  EXPECT_NE(doubt_of("pinhole_radtan", {-0.3, 0.1, 0, 0, -50}).find("(k3 = -50)"), std::string::npos);
  EXPECT_NE(doubt_of("pinhole_radtan", {-0.3, 0.1, 0.9, 0}).find("(p1 = 0.9)"), std::string::npos);
  EXPECT_NE(doubt_of("pinhole_rational", {0, 0, 0, 0, 0, 40, 0, 0}).find("(k4 = 40)"), std::string::npos);
  EXPECT_NE(doubt_of("kannala_brandt", {0, -5, 0, 0}).find("(k2 = -5)"), std::string::npos);
}

TEST(DistortionDoubt, AnAbsurdStretchIsToldWithTheCoefficient) {
  for (const double k1 : {5.0, 500.0, 1e6}) {
    const std::string doubt = doubt_of("pinhole_radtan", {k1, 0, 0, 0});
    EXPECT_NE(doubt.find("times as far"), std::string::npos) << doubt;
    EXPECT_NE(doubt.find("(k1 = "), std::string::npos) << doubt;
  }
  EXPECT_NE(doubt_of("kannala_brandt", {500, 0, 0, 0}).find("(k1 = 500)"), std::string::npos);
}

/// What simulators and calibrations of others have: wide, strongly distorted, with large coefficients that
/// take each other back, without a picture size.
TEST(DistortionDoubt, RealLensesAreBelieved) {
  std::vector<Camera> cameras = test::example_cameras();
  // Of the examples, the one that is to fold.
  std::erase_if(cameras, [](const Camera& camera) { return camera.parameters[4] == -0.45; });
  cameras.push_back(
      make_camera("pinhole_radtan", 752, 480,
                  {458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}));
  cameras.push_back(make_camera("pinhole_radtan", 640, 480,
                                {517.3, 516.5, 318.6, 255.3, 0.2624, -0.9531, -0.0054, 0.0026, 1.1633}));
  cameras.push_back(
      make_camera("kannala_brandt", 512, 512,
                  {190.978, 190.973, 254.932, 256.897, 0.00348238, 0.000715034, -0.00205323, 0.000202936}));
  // A telephoto lens: coefficients are large where the angles are small.
  cameras.push_back(make_camera("pinhole_radtan", 1920, 1200, {12000, 12000, 960, 600, 8, -300, 0, 0}));
  for (Camera camera : cameras) {
    EXPECT_EQ(distortion_doubt(camera), std::nullopt) << test::describe(camera);
    camera.width = camera.height = 0;
    EXPECT_EQ(distortion_doubt(camera), std::nullopt) << test::describe(camera);
  }
}

}  // namespace
}  // namespace ca2
