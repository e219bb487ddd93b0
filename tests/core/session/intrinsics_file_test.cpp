// Intrinsics files as ROS, Kalibr and OpenCV write them, and what must be refused.
#include "core/session/intrinsics_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/core.hpp>
#include <random>

#include "core/session/rig.h"

namespace ca2 {
namespace {

Result<Camera> parse(const std::string& text, const std::string& camera = {}) {
  return parse_intrinsics(text, "cam.yaml", camera);
}

void expect_camera(const Result<Camera>& camera, const std::string& model, int width, int height,
                   const std::vector<double>& parameters) {
  ASSERT_TRUE(camera) << camera.error().text();
  EXPECT_EQ(camera->model->name(), model);
  EXPECT_EQ(camera->width, width);
  EXPECT_EQ(camera->height, height);
  EXPECT_EQ(std::vector<double>(camera->parameters.begin(), camera->parameters.end()), parameters);
}

void expect_refused(const std::string& text, const std::string& words, const std::string& camera = {}) {
  const Result<Camera> result = parse(text, camera);
  ASSERT_FALSE(result) << text;
  EXPECT_EQ(result.error().code, ErrorCode::config);
  EXPECT_NE(result.error().text().find(words), std::string::npos) << result.error().text();
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

const std::string ros = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [438.78, 0., 305.59, 0, 437.35, 243.74, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.36, 0.1, 6.1e-4, -0.0005, 0]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [393.65, 0, 322.8, 0, 0, 393.65, 241.1, 0, 0, 0, 1, 0]}
)";

const std::string flat = R"(distortion_model: "fisheye"
width: 1920
height: 1208
D: [-0.054, -0.078, 0.096, -0.052]
K: [1176.93,0.0,962.275,0.0,1177.72,612.725,0.0,0.0,1]
)";

const std::string kalibr = R"(cam0:
  camera_model: pinhole
  distortion_model: radtan
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]
  intrinsics: [458.654, 457.296, 367.215, 248.375]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1: [[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
  camera_model: ds
  distortion_model: none
  distortion_coeffs: []
  intrinsics: [-0.18, 0.59, 157.1, 157.2, 254.9, 256.9]
  resolution: [512, 513]
cam2:
  camera_model: pinhole
  distortion_model: equidistant
  distortion_coeffs: [-0.01, 0.02, -0.03, 0.004]
  intrinsics: [286, 287, 418, 402]
  resolution: [848, 800]
cam3:
  camera_model: eucm
  distortion_model: none
  distortion_coeffs: []
  intrinsics: [0.6, 1.1, 200, 200, 320, 240]
  resolution: [640, 480]
)";

TEST(IntrinsicsFile, RosNested) {
  expect_camera(parse(ros), "pinhole_radtan", 640, 480,
                {438.78, 437.35, 305.59, 243.74, -0.36, 0.1, 6.1e-4, -0.0005, 0});
  expect_camera(parse(ros, "narrow_stereo"), "pinhole_radtan", 640, 480,
                {438.78, 437.35, 305.59, 243.74, -0.36, 0.1, 6.1e-4, -0.0005, 0});
  std::string rational = replaced(ros, "plumb_bob", "rational_polynomial");
  rational = replaced(rational, "cols: 5", "cols: 8");
  rational = replaced(rational, "-0.0005, 0]", "-0.0005, 1, 2, 3, 4]");
  expect_camera(parse(rational), "pinhole_rational", 640, 480,
                {438.78, 437.35, 305.59, 243.74, -0.36, 0.1, 6.1e-4, -0.0005, 1, 2, 3, 4});
}

TEST(IntrinsicsFile, RosFlat) {
  const std::vector<double> parameters{1176.93, 1177.72, 962.275, 612.725, -0.054, -0.078, 0.096, -0.052};
  expect_camera(parse(flat), "kannala_brandt", 1920, 1208, parameters);
  expect_camera(parse(replaced(flat, "fisheye", "equidistant")), "kannala_brandt", 1920, 1208, parameters);
  // As `ros2 topic echo` prints it.
  const std::string echo =
      "height: 480\nwidth: 640\ndistortion_model: plumb_bob\nd: []\n"
      "k:\n- 500.0\n- 0.0\n- 320.0\n- 0.0\n- 501.0\n- 240.0\n- 0.0\n- 0.0\n- 1.0\n"
      "binning_x: 0\nroi: {x_offset: 0, y_offset: 0, height: 0, width: 0}\n---\n";
  expect_camera(parse(echo), "pinhole_radtan", 640, 480, {500, 501, 320, 240, 0, 0, 0, 0});
  expect_refused(replaced(echo, "binning_x: 0", "binning_x: 2"), "binning_x is over 1");
  expect_refused(replaced(echo, "x_offset: 0", "x_offset: 8"), "region of interest");
}

TEST(IntrinsicsFile, RealRosFile) {
  const char* data = std::getenv("CA2_TEST_DATA");
  if (!data) GTEST_SKIP() << "CA2_TEST_DATA is not set";
  expect_camera(read_intrinsics(std::filesystem::path(data) / "acfr_vlp16/camera_info.yaml"),
                "kannala_brandt", 1920, 1208,
                {1176.93, 1177.72, 962.275, 612.725, -0.0540096, -0.0784275, 0.0959641, -0.0515253});
}

TEST(IntrinsicsFile, KalibrCamchain) {
  expect_camera(parse(kalibr, "cam0"), "pinhole_radtan", 752, 480,
                {458.654, 457.296, 367.215, 248.375, -0.28, 0.07, 0.0002, 1.8e-05});
  expect_camera(parse(kalibr, "cam1"), "double_sphere", 512, 513, {157.1, 157.2, 254.9, 256.9, -0.18, 0.59});
  expect_camera(parse(kalibr, "cam2"), "kannala_brandt", 848, 800,
                {286, 287, 418, 402, -0.01, 0.02, -0.03, 0.004});
  expect_refused(kalibr, "cam0, cam1, cam2, cam3");
  expect_refused(kalibr, "there is no camera 'cam7'", "cam7");
  expect_refused(kalibr, "cam.yaml:22:17: camera model 'eucm' is not supported", "cam3");
  expect_refused(replaced(kalibr, "radtan", "fov"), "cam.yaml:3:21: distortion model 'fov'", "cam0");
  expect_refused(replaced(kalibr, "model: ds", "model: omni"), "'omni' is not supported", "cam1");
  const std::string alone = replaced(kalibr.substr(0, kalibr.find("cam1")), "radtan", "none");
  expect_refused(alone, "has no coefficients, not 4");
  expect_camera(parse(replaced(alone, "[-0.28, 0.07, 0.0002, 1.8e-05]", "[]")), "pinhole_radtan", 752, 480,
                {458.654, 457.296, 367.215, 248.375, 0, 0, 0, 0});
}

/// A file that OpenCV itself wrote.
std::string opencv_file(const std::vector<double>& D, const std::string& more_key = {}) {
  cv::FileStorage storage("x.yaml",
                          cv::FileStorage::WRITE | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
  storage << "calibration_time"
          << "Sun Nov 22 10:00:00 2026";
  storage << "image_width" << 640 << "image_height" << 480;
  if (!more_key.empty()) storage << more_key << 1;
  storage << "camera_matrix" << cv::Mat(cv::Matx33d(600.25, 0, 320.125, 0, 601.5, 240, 0, 0, 1));
  storage << "distortion_coefficients" << cv::Mat(D, true).reshape(1, 1);
  return storage.releaseAndGetString();
}

TEST(IntrinsicsFile, OpenCvsOwnFiles) {
  for (const std::size_t count : {4, 5, 8}) {
    std::vector<double> parameters{600.25, 601.5, 320.125, 240}, D;
    for (std::size_t i = 0; i < count; ++i) D.push_back(0.01 * static_cast<double>(i + 1) / 3);
    parameters.insert(parameters.end(), D.begin(), D.end());
    expect_camera(parse(opencv_file(D)), count == 8 ? "pinhole_rational" : "pinhole_radtan", 640, 480,
                  parameters);
    if (count == 4) {
      expect_camera(parse(opencv_file(D, "fisheye_model")), "kannala_brandt", 640, 480, parameters);
    } else {
      expect_refused(opencv_file(D, "fisheye_model"), "where a fisheye has 4");
    }
  }
  for (const std::size_t count : {1, 3, 6, 12, 14}) {
    expect_refused(opencv_file(std::vector<double>(count, 0.1)),
                   std::to_string(count) + " distortion coefficients");
  }
  std::string other = opencv_file({0.1, 0.2, 0.3, 0.4});
  other = replaced(replaced(other, "camera_matrix", "K"), "distortion_coefficients", "distCoeffs");
  other = replaced(replaced(other, "image_width: 640", "imageSize: [ 640, 480 ]"), "image_height: 480", "");
  expect_camera(parse(other), "pinhole_radtan", 640, 480, {600.25, 601.5, 320.125, 240, 0.1, 0.2, 0.3, 0.4});
}

TEST(IntrinsicsFile, ProblemsSayWhereAndAllOfThem) {
  expect_refused(replaced(ros, "305.59", "abc"), "cam.yaml:7:22: the camera matrix is not a finite number");
  expect_refused(replaced(ros, "305.59", ".nan"), "not a finite number");
  expect_refused(replaced(ros, "305.59", "1e999"), "not a finite number");
  expect_refused(replaced(ros, "305.59, 0, ", "305.59, 0.5, "), "is not [fx 0 cx");
  expect_refused(replaced(ros, "[438.78, 0.", "[438.78, 2"), "skew");
  expect_refused(replaced(ros, "[438.78", "[-438.78"), "fx is not positive");
  expect_refused(replaced(ros, "image_width: 640", "image_width: 640.5"), "cam.yaml:1:14:");
  expect_refused(replaced(ros, "image_width: 640", "image_width: 30001"), "from 1 to 30000");  // as a rig's
  expect_refused(replaced(ros, "image_width: 640", ""), "'image_width' is missing");
  expect_refused(replaced(ros, "cols: 5", "cols: 4"), "rows times cols");
  expect_refused(replaced(ros, "plumb_bob", "weird"), "cam.yaml:8:19: distortion model 'weird'");
  expect_refused(replaced(ros, "plumb_bob", "rational_polynomial"), "rational_polynomial has 8");
  expect_refused(replaced(flat, "distortion_model: \"fisheye\"", ""), "'distortion_model' is missing");
  expect_refused(replaced(flat, "-0.054, ", ""), "3 distortion coefficients, where a fisheye has 4");
  expect_refused(flat, "there is no camera 'left'", "left");

  const auto many = parse("camera_matrix: 3\nD: [a, b]\nwidth: -1\n");
  ASSERT_FALSE(many);
  EXPECT_GE(many.error().problems.size(), 4u) << many.error().text();
}

TEST(IntrinsicsFile, HostileInputIsAnError) {
  for (const char* text :
       {"", "\n", "42", "[]", "{}", "a: [", "%YAML:", "%YAML:1.0", "%YAML:1.0\n---\n", "K: &a *a", "K: [*x]",
        "cam0: {camera_model: [], intrinsics: {}}", "? {a: b}\n: c",
        "\t\t:", "camera_model: ds\nintrinsics: 3", "K: {data: {data: [1]}}\nD: {data: ~}"}) {
    EXPECT_FALSE(parse(text)) << text;
  }
  EXPECT_FALSE(parse(std::string(100000, '[')));
  EXPECT_FALSE(parse(std::string(100000, '{')));
  std::string bomb = "a: &a [1, 1]\n";
  for (char c = 'b'; c < 'z'; ++c) {
    const std::string before(1, static_cast<char>(c - 1));
    bomb += std::string(1, c) + ": &" + c + " [*" + before + ", *" + before + "]\n";
  }
  EXPECT_FALSE(parse(bomb + "K: *y\nD: *y\n"));

  // Seeded damage to good files: an answer or an error, never a crash, and an answer is a valid camera.
  std::mt19937_64 rng(1);
  for (const std::string& good : {ros, flat, kalibr, opencv_file({0.1, 0.2, 0.3, 0.4, 0.5})}) {
    for (int i = 0; i < 500; ++i) {
      std::string text = good;
      for (int n = static_cast<int>(rng() % 4); n >= 0; --n) {
        const std::size_t at = rng() % text.size();
        if (rng() % 2) {
          text[at] = static_cast<char>(rng() % 128);
        } else {
          text.erase(at, rng() % 8);
        }
      }
      const auto camera = parse(text, rng() % 2 ? "cam0" : "");
      if (camera) {
        EXPECT_FALSE(camera->model->invalid(camera->parameters)) << text;
      }
    }
  }
}

TEST(IntrinsicsFile, AMissingFileIsAnError) {
  EXPECT_FALSE(read_intrinsics("/nonexistent/cam.yaml"));
}

}  // namespace
}  // namespace ca2
