/// @file Composing through known frames, and refusing to where they contradict the calibration.
#include "core/export/frame_graph.h"

#include "core/export/known_frames.h"
#include "tests/core/export/example.h"

namespace ca2 {
namespace {

using namespace test;

const char* urdf = R"(<?xml version="1.0"?>
<robot name="r">
  <link name="base_link"/>
  <joint name="mast" type="fixed"><parent link="base_link"/><child link="mast"/>
    <origin xyz="0.1 -0.2 1.5" rpy="0.1 0.2 0.3"/></joint>
  <joint name="camera" type="fixed"><parent link="mast"/><child link="left_camera_link"/>
    <origin xyz="0 0 0.25"/></joint>
  <joint name="wheel" type="continuous"><parent link="base_link"/><child link="wheel"/></joint>
</robot>)";

TEST(FrameGraph, ComposesThroughARobotsUrdfAndTheCamerasLink) {
  const Example e = example();
  FrameGraph frames = e.request.frames;
  const auto known = parse_known_frames(urdf, "robot.urdf");
  ASSERT_TRUE(known) << known.error().text();
  ASSERT_EQ(known->size(), 2u) << "a wheel's joint turns: it has no pose to know";
  for (const FrameTransform& t : *known) ASSERT_TRUE(frames.add(t, "robot.urdf"));
  EXPECT_FALSE(frames.between("base_link", "top_lidar"));
  frames.connect_links();
  const auto found = frames.between("base_link", "top_lidar");
  ASSERT_TRUE(found) << found.error().text();
  Eigen::Matrix3d R_link_optical;
  R_link_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Pose T_base_mast{urdf_rotation(0.1, 0.2, 0.3), {0.1, -0.2, 1.5}};
  const Pose T_mast_link{Eigen::Matrix3d::Identity(), {0, 0, 0.25}};
  expect_same(found->T,
              T_base_mast * T_mast_link * Pose{R_link_optical, Eigen::Vector3d::Zero()} * e.T_left_top);
  ASSERT_TRUE(found->covariance);
  // What is known on the parent's side does not change a right perturbation.
  EXPECT_LT((*found->covariance - e.request.calibration.transforms[0].covariance).norm(), 1e-15);
}

TEST(FrameGraph, CovarianceMovesToTheOtherSideAndThroughKnownFrames) {
  // Against samples: T_top_left, and T_left_mount through a known T_top_mount.
  const Example e = example();
  FrameGraph frames = e.request.frames;
  const Pose T_top_mount{urdf_rotation(0.4, -0.3, 1), {0.5, 2, -1}};
  ASSERT_TRUE(frames.add({"top", "mount", T_top_mount}, "test"));
  const auto back = frames.between("top_lidar", "left_camera_optical");
  const auto mount = frames.between("left_camera_optical", "mount");
  ASSERT_TRUE(back && mount && back->covariance && mount->covariance);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 1e-3);
  Matrix6d sampled_back = Matrix6d::Zero(), sampled_mount = Matrix6d::Zero();
  constexpr int samples = 20000;
  for (int i = 0; i < samples; ++i) {
    Vector6d d;
    for (int k = 0; k < 6; ++k) d(k) = normal(random);
    const Pose T_left_top = e.T_left_top.perturbed(d);
    const Vector6d b = back->T.difference(T_left_top.inverse());
    const Vector6d m = mount->T.difference(T_left_top * T_top_mount);
    sampled_back += b * b.transpose() / samples;
    sampled_mount += m * m.transpose() / samples;
  }
  EXPECT_LT((sampled_back - *back->covariance).norm(), 0.05 * back->covariance->norm());
  EXPECT_LT((sampled_mount - *mount->covariance).norm(), 0.05 * mount->covariance->norm());
  // Two estimates in a row: their correlation is not known.
  FrameGraph chain = e.request.frames;
  EXPECT_FALSE((frames.between("top_lidar", "left_camera_optical").value() *
                frames.between("left_camera_optical", "side_lidar").value())
                   .covariance);
}

TEST(FrameGraph, WhatContradictsTheCalibrationIsRefused) {
  const Example e = example();
  FrameGraph frames = e.request.frames;
  Pose nearly = e.T_left_top;
  nearly.t.x() += 1e-6;
  EXPECT_TRUE(frames.add({"left", "top", nearly}, "robot.yaml"));
  nearly.t.x() += 5e-3;
  const auto added = frames.add({"left_camera_optical", "top_lidar", nearly}, "robot.yaml");
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().code, ErrorCode::config);
  EXPECT_NE(added.error().text().find("5.0 mm"), std::string::npos) << added.error().text();
}

TEST(FrameGraph, UnknownNamesListTheKnownOnes) {
  FrameGraph frames = example().request.frames;
  EXPECT_EQ(*frames.find("top"), "top_lidar");
  EXPECT_EQ(*frames.find("left_camera_link"), "left_camera_link") << "known by custom";
  const auto found = frames.find("base_link");
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::usage);
  EXPECT_NE(found.error().text().find("side_lidar"), std::string::npos);
}

TEST(FrameGraph, TwoSensorsWithOneFrameAreRefused) {
  Example e = example();
  for (CalibratedTransform& t : e.request.calibration.transforms) t.child_frame = "lidar";
  const auto frames = FrameGraph::of(e.request.calibration);
  ASSERT_FALSE(frames);
  EXPECT_EQ(frames.error().code, ErrorCode::config);
}

TEST(FrameGraph, CustomaryNamesOfLinks) {
  EXPECT_EQ(link_name("left_camera_optical"), "left_camera_link");
  EXPECT_EQ(link_name("camera_color_optical_frame"), "camera_color_link");
  EXPECT_EQ(link_name("camera0/camera_optical_link"), "camera0/camera_link");
  EXPECT_EQ(link_name("left"), "left_link");
}

TEST(KnownFrames, YamlListWithTheRigsKeys) {
  const auto known = parse_known_frames(
      "extrinsics:\n  - {parent: base_link, child: top, translation: [1, 2, 3], rotation: {x: 0, y: 0, z: 1, "
      "w: 0}}\n",
      "robot.yaml");
  ASSERT_TRUE(known) << known.error().text();
  ASSERT_EQ(known->size(), 1u);
  expect_same((*known)[0].T_parent_child, {quaternion_rotation(0, 0, 1, 0), {1, 2, 3}});
}

TEST(KnownFrames, BadFilesSayWhere) {
  const std::pair<const char*, const char*> cases[] = {
      {"<robot><joint", "robot.urdf:1"},
      {"<launch/>", "no <robot>"},
      {"<robot>\n\n<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='${x} 0 "
       "0'/></joint></robot>",
       "robot.urdf:3"},
      {"<robot><joint name='j' type='fixed'><parent link='a'/></joint></robot>", "lacks a parent or child"},
      {"extrinsics: 4\n", "robot.urdf:1"},
      {"extrinsics:\n- {parent: a, child: b, translation: [1, 2]}\n", "robot.urdf:2"},
  };
  for (const auto& [text, word] : cases) {
    const auto known = parse_known_frames(text, "robot.urdf");
    ASSERT_FALSE(known) << text;
    EXPECT_EQ(known.error().code, ErrorCode::config);
    EXPECT_NE(known.error().text().find(word), std::string::npos) << known.error().text();
  }
}

}  // namespace
}  // namespace ca2
