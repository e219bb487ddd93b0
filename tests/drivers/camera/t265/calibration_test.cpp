/// The factory's numbers in our terms.
#include "drivers/camera/t265/calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/camera/t265/golden.h"

namespace ca2::t265 {
namespace {

/// As a real unit: imagers 64 mm apart, each turned a little, pose frame x right, y up, z backwards.
FisheyeCalibration fisheye(double side) {
  FisheyeCalibration out;
  out.intrinsics = *parse_camera_intrinsics(golden::bytes(golden::intrinsics_left));
  out.extrinsics.reference = Sensor::pose;
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Eigen::Matrix3d R = so3_exp(Eigen::Vector3d(0.002, -0.003 * side, 0.004)) * flip;
  Eigen::Map<Eigen::Matrix3f>(out.extrinsics.R.data()) = R.cast<float>();
  out.extrinsics.t = {static_cast<float>(0.032 * side), 0.0001f, 0.0002f};
  return out;
}

TEST(T265Calibration, IsTheRigOfTwoFisheyes) {
  const auto streams = camera_streams(fisheye(-1), fisheye(1));
  ASSERT_TRUE(streams) << streams.error().text();
  ASSERT_EQ(streams->size(), 2u);
  EXPECT_EQ((*streams)[0].name, "left");
  EXPECT_EQ((*streams)[1].name, "right");
  EXPECT_EQ((*streams)[1].width, 848);
  EXPECT_EQ((*streams)[1].height, 800);

  // The projection, by the formula that the device's vendor gives.
  const Camera& camera = *(*streams)[0].intrinsics;
  EXPECT_EQ(camera.model->name(), "kannala_brandt");
  const double k[] = {-0.004348, 0.037126, -0.035539, 0.005773};
  const Eigen::Vector3d p(0.7, -0.4, 0.5);
  const double theta = std::atan2(p.head<2>().norm(), p.z()), t2 = theta * theta;
  const double bent = theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  const Eigen::Vector2d d = bent * p.head<2>().normalized();
  const auto pixel = camera.project(p);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 286.222 * d.x() + 419.467, 1e-3);
  EXPECT_NEAR(pixel->y(), 287.480 * d.y() + 386.975, 1e-3);

  // A point 1 m ahead of the right imager lies to the right of the left one's axis, by the baseline.
  const Pose T_left_right = *(*streams)[1].T_first_this;
  EXPECT_NEAR(T_left_right.t.norm(), 0.064, 1e-5);
  EXPECT_NEAR(T_left_right.t.x(), 0.064, 1e-3);
  EXPECT_LT(so3_log(T_left_right.R).norm(), 0.01);
  EXPECT_LT((T_left_right.R * T_left_right.R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  // And through the pose frame, term by term.
  const FisheyeCalibration left = fisheye(-1), right = fisheye(1);
  const auto to_pose = [](const FisheyeCalibration& c, const Eigen::Vector3d& q) -> Eigen::Vector3d {
    const auto& R = c.extrinsics.R;
    const auto& t = c.extrinsics.t;
    Eigen::Vector3d out;
    for (std::size_t row = 0; row < 3; ++row) {
      out[static_cast<int>(row)] = R[row] * q.x() + R[3 + row] * q.y() + R[6 + row] * q.z() + t[row];
    }
    return out;
  };
  const Eigen::Vector3d q(0.3, -0.2, 1.5);
  EXPECT_LT((to_pose(right, q) - to_pose(left, T_left_right * q)).norm(), 1e-6);
  EXPECT_EQ((*streams)[0].T_first_this->t, Eigen::Vector3d(0, 0, 0));
}

std::string refusal(const FisheyeCalibration& right) {
  const auto streams = camera_streams(fisheye(-1), right);
  return streams ? "" : streams.error().text();
}

TEST(T265Calibration, WhatCannotBeOneIsRefusedWithAReason) {
  const auto with = [](auto change) {
    FisheyeCalibration right = fisheye(1);
    change(right);
    return refusal(right);
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_NE(with([](auto& c) { c.intrinsics.model = 1; }).find("distortion model 1"), std::string::npos);
  EXPECT_NE(with([](auto& c) { c.intrinsics.width = 0; }).find("pictures of 0 x 800"), std::string::npos);
  EXPECT_NE(with([](auto& c) { c.intrinsics.fx = std::nanf(""); }), "");
  EXPECT_NE(with([](auto& c) { c.intrinsics.fy = -286; }), "");
  EXPECT_NE(with([](auto& c) { c.extrinsics.reference = Sensor::gyro; }).find("sensor 0x04"),
            std::string::npos);
  EXPECT_NE(with([](auto& c) { c.extrinsics.R[4] *= 1.01f; }).find("no rotation"), std::string::npos);
  EXPECT_NE(with([](auto& c) {
              for (float& r : c.extrinsics.R) r = -r;
            }).find("no rotation"),
            std::string::npos);
  EXPECT_NE(with([](auto& c) { c.extrinsics.R[0] = std::nanf(""); }).find("no rotation"), std::string::npos);
  EXPECT_NE(with([](auto& c) { c.extrinsics.t[1] = 32; }).find("32"), std::string::npos);
  EXPECT_NE(with([](auto& c) { c.extrinsics.t[1] = std::nanf(""); }), "");
  const std::string text = with([](auto& c) { c.intrinsics.model = 1; });
  EXPECT_NE(text.find("right imager"), std::string::npos) << text;
}

}  // namespace
}  // namespace ca2::t265
