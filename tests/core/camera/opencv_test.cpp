// OpenCV's projections as an independent oracle.
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>
#include <vector>

#include "tests/core/camera/examples.h"

namespace ca2 {
namespace {

/// OpenCV's pixel of a point in the camera frame.
Eigen::Vector2d opencv_pixel(const Camera& camera, const Eigen::Vector3d& p) {
  const auto& q = camera.parameters;
  const cv::Matx33d K(q[0], 0, q[2], 0, q[1], q[3], 0, 0, 1);
  std::vector<double> D;
  for (Eigen::Index i = 4; i < q.size(); ++i) D.push_back(q[i]);
  const std::vector<cv::Point3d> points{{p.x(), p.y(), p.z()}};
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d zero(0, 0, 0);
  if (camera.model->name() == "kannala_brandt") {
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, D);
  } else {
    cv::projectPoints(points, zero, zero, K, D, pixels);
  }
  return {pixels[0].x, pixels[0].y};
}

TEST(OpenCv, ProjectsToTheSamePixels) {
  std::mt19937_64 rng(1);
  for (const Camera& camera : test::example_cameras()) {
    if (camera.model->name() == "double_sphere") continue;  // OpenCV has no such model
    int seen = 0;
    for (int i = 0; i < 500; ++i) {
      const auto ray = camera.unproject(test::random_pixel(camera, rng));
      if (!ray || ray->z() < 0.01) continue;  // OpenCV's fisheye ends at 90 degrees
      const Eigen::Vector3d p = *ray * 4.2;
      const auto pixel = camera.project(p);
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - opencv_pixel(camera, p)).norm(), 1e-9) << test::describe(camera);
      ++seen;
    }
    EXPECT_GT(seen, 200) << test::describe(camera);
  }
}

}  // namespace
}  // namespace ca2
