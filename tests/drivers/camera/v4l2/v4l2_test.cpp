/// Opening, controls and errors of V4L2 cameras, played by umockdev. Streaming is tested in the guest machine
/// (tests/devices/v4l2).
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>

#include "drivers/camera/camera_driver.h"
#include "drivers/camera/v4l2/controls.h"
#include "tests/drivers/camera/v4l2/mock_v4l2.h"

namespace ca2 {
namespace {

using Writes = std::vector<std::pair<std::uint32_t, int>>;

test::MockV4l2Device webcam() {
  test::MockV4l2Device device;
  device.abilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  device.formats = {{V4L2_PIX_FMT_MJPEG, {{640, 480}, {1280, 720}}},
                    {V4L2_PIX_FMT_YUYV, {{640, 480}, {320, 240}}}};
  device.controls = {
      {V4L2_CID_BRIGHTNESS, V4L2_CTRL_TYPE_INTEGER, "Brightness", -64, 64, 0, 0},
      {V4L2_CID_AUTOGAIN, V4L2_CTRL_TYPE_BOOLEAN, "Gain, Automatic", 0, 1, 1, 0},
      {V4L2_CID_GAIN, V4L2_CTRL_TYPE_INTEGER, "Gain", 0, 100, 10, 0},
      {V4L2_CID_EXPOSURE_AUTO, V4L2_CTRL_TYPE_MENU, "Auto Exposure", 0, 3, 3, 0},
      {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, "Exposure Time, Absolute", 3, 2047, 250, 0},
      {V4L2_CID_EXPOSURE_AUTO_PRIORITY, V4L2_CTRL_TYPE_BOOLEAN, "Exposure, Dynamic Framerate", 0, 1, 1, 0}};
  return device;
}

class V4l2 : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::MockV4l2::possible()) GTEST_SKIP() << "run it as umockdev-wrapper test_drivers_camera_v4l2";
    mock_ = std::make_unique<test::MockV4l2>();
  }

  static std::string error_of(SourceOptions source) {
    source["driver"] = "v4l2";
    const auto camera = open_camera(source);
    return camera ? "" : camera.error().text();
  }

  std::unique_ptr<test::MockV4l2> mock_;
};

TEST_F(V4l2, TheOnlyCameraIsFoundAndItsOtherNodeIsNot) {
  test::MockV4l2Device metadata = webcam();
  metadata.number = 1;
  metadata.abilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  mock_->plug_in(webcam());
  mock_->plug_in(metadata);
  const auto camera = open_camera({{"driver", "v4l2"}});
  ASSERT_TRUE(camera) << camera.error().text();
  EXPECT_EQ((*camera)->description(), "Mock camera (usb-mock-1)");
  // Uncompressed before compressed, whatever the camera lists first.
  EXPECT_EQ((*camera)->streams()[0].format, "YUYV");
  EXPECT_EQ((*camera)->streams()[0].width, 640);
  EXPECT_NEAR((*camera)->frame_rate(), 30, 1e-9);
  EXPECT_NE(error_of({{"id", "/dev/video1"}}).find("is no camera"), std::string::npos);
}

TEST_F(V4l2, SeveralCamerasMustBeTold) {
  test::MockV4l2Device second = webcam();
  second.number = 4;
  mock_->plug_in(webcam());
  mock_->plug_in(second);
  EXPECT_NE(error_of({}).find("say which with 'id': /dev/video0, /dev/video4"), std::string::npos)
      << error_of({});
  EXPECT_EQ(error_of({{"id", "/dev/video4"}}), "");
}

TEST_F(V4l2, WhatTheCameraMakesOfAWishIsNoticed) {
  mock_->plug_in(webcam());
  const std::string size = error_of({{"width", "1000"}, {"height", "700"}});
  EXPECT_NE(size.find("makes YUYV 640x480 of YUYV 1000x700; it has 640x480 320x240"), std::string::npos)
      << size;
  EXPECT_EQ(error_of({{"format", "MJPG"}, {"width", "1280"}, {"height", "720"}}), "");
  const std::string format = error_of({{"format", "GREY"}});
  EXPECT_NE(format.find("no format 'GREY'; it has MJPG, YUYV"), std::string::npos) << format;
  const auto camera = open_camera({{"driver", "v4l2"}, {"frame_rate", "60"}});
  ASSERT_TRUE(camera);
  ASSERT_EQ((*camera)->warnings().size(), 1u);
  EXPECT_EQ((*camera)->warnings()[0], "gives 30 pictures per second instead of 60");
}

TEST_F(V4l2, AutomaticsAreSwitchedOffBeforeTheirValues) {
  mock_->plug_in(webcam());
  const auto device = V4l2Device::open("/dev/video0");
  ASSERT_TRUE(device) << device.error().text();
  const V4l2Controls controls(*device);
  EXPECT_EQ(controls.exposure(), 0);  // automatic
  ASSERT_TRUE(controls.write({{"gain", "50"}, {"exposure_us", "10000"}}));
  EXPECT_EQ(mock_->writes(), (Writes{{V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL},
                                     {V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0},
                                     {V4L2_CID_EXPOSURE_ABSOLUTE, 100},
                                     {V4L2_CID_AUTOGAIN, 0},
                                     {V4L2_CID_GAIN, 50}}));
  EXPECT_DOUBLE_EQ(controls.exposure(), 0.01);
  const auto now = controls.read();
  EXPECT_EQ(now.at("exposure_us").value, "10000");
  EXPECT_EQ(now.at("exposure_us").limits, "300 to 204700, auto");
  EXPECT_EQ(now.at("gain").value, "50");
  ASSERT_TRUE(controls.write("exposure_us", "auto"));
  EXPECT_EQ(mock_->writes().back(),
            Writes::value_type(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY));
}

TEST_F(V4l2, WrongControlsAreRefusedWhereTheyAreGiven) {
  mock_->plug_in(webcam());
  EXPECT_NE(error_of({{"controls", "gain=101"}}).find("'gain' must be from 0 to 100"), std::string::npos);
  EXPECT_NE(error_of({{"controls", "gian=1"}}).find("did you mean 'gain'?"), std::string::npos);
  EXPECT_NE(error_of({{"controls", "gain"}}).find("'controls' has 'gain'"), std::string::npos);
  EXPECT_NE(error_of({{"exposure_us", "1"}}).find("'exposure_us' must be from 300 to 204700"),
            std::string::npos);
}

TEST_F(V4l2, ErrnosBecomeWords) {
  test::MockV4l2Device busy = webcam();
  busy.errors[VIDIOC_S_FMT] = EBUSY;
  mock_->plug_in(busy);
  EXPECT_NE(
      error_of({}).find("cannot set its format: Device or resource busy; another program uses the camera"),
      std::string::npos);
  test::MockV4l2Device gone = webcam();
  gone.number = 1;
  gone.errors[VIDIOC_QUERYCAP] = ENODEV;
  mock_->plug_in(gone);
  EXPECT_NE(error_of({{"id", "/dev/video1"}}).find("No such device; is the camera plugged in?"),
            std::string::npos);
  test::MockV4l2Device full = webcam();
  full.number = 2;
  full.errors[VIDIOC_REQBUFS] = ENOSPC;
  mock_->plug_in(full);
  const auto camera = open_camera({{"driver", "v4l2"}, {"id", "/dev/video2"}});
  ASSERT_TRUE(camera);
  const auto started = (*camera)->start();
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().text().find("the USB bus has no bandwidth left"), std::string::npos);
  test::MockV4l2Device stubborn = webcam();
  stubborn.number = 3;
  stubborn.controls[2].refuses = EACCES;
  mock_->plug_in(stubborn);
  const auto device = V4l2Device::open("/dev/video3");
  ASSERT_TRUE(device);
  const auto written = V4l2Controls(*device).write("gain", "5");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().text().find("control 'gain' is not active now"), std::string::npos);
}

TEST_F(V4l2, ADriverWithoutAnEndIsSurvived) {
  test::MockV4l2Device endless = webcam();
  endless.formats.assign(2000, endless.formats[1]);
  mock_->plug_in(endless);
  EXPECT_EQ(error_of({}), "");
}

}  // namespace
}  // namespace ca2
