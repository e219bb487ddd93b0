/// @file Formats of cameras, read back by OpenCV's FileStorage, by yaml-cpp, and by our own reader of such
/// files.
#include <yaml-cpp/yaml.h>

#include <opencv2/core.hpp>

#include "core/session/intrinsics_file.h"
#include "tests/core/export/example.h"

namespace ca2 {
namespace {

using namespace test;

/// An example whose left camera has this model.
Example with_camera(const char* model, const std::vector<double>& shape) {
  Example e = example();
  e.request.calibration.cameras["left"].camera = example_camera(model, shape);
  return e;
}

const std::vector<std::pair<const char*, std::vector<double>>> cameras{
    {"pinhole_radtan", {-0.1, 0.05, 1e-4, -2e-4}},
    {"pinhole_radtan", {-0.1, 0.05, 1e-4, -2e-4, 0.011}},
    {"pinhole_rational", {0.3, 0.05, 1e-4, -2e-4, 0.011, 0.35, 0.07, 0.001}},
    {"kannala_brandt", {0.01, -0.002, 3e-4, -1e-5}},
    {"double_sphere", {-0.2, 0.58}},
};

/// The distortion padded by zeros: a k3 that is not there is 0.
std::vector<double> parameters(const Camera& camera) {
  std::vector<double> p(camera.parameters.begin(), camera.parameters.end());
  if (camera.model->name() == "pinhole_radtan") p.resize(9, 0);
  return p;
}

TEST(CameraExports, OurReaderGivesTheSameCameraOrTheFormatIsRefused) {
  int written = 0;
  for (const auto& [model, shape] : cameras) {
    Example e = with_camera(model, shape);
    e.request.parent = "left";
    const Camera& truth = e.request.calibration.cameras["left"].camera;
    for (const char* format : {"camera_info", "kalibr", "opencv"}) {
      const auto files = find_exporter(format)->write(e.request);
      if (!files) {
        EXPECT_EQ(files.error().code, ErrorCode::refused) << model << " " << format;
        EXPECT_NE(files.error().text().find(model), std::string::npos) << files.error().text();
        continue;
      }
      ++written;
      ASSERT_EQ(files->size(), 1u);
      const auto camera = parse_intrinsics(files->front().content, files->front().name);
      ASSERT_TRUE(camera) << camera.error().text() << files->front().content;
      EXPECT_EQ(camera->model, truth.model);
      EXPECT_EQ(parameters(*camera), parameters(truth)) << model << " " << format;
      EXPECT_EQ(camera->width, 640);
      EXPECT_EQ(camera->height, 480);
    }
  }
  // Kalibr has no k3 and no rational model; OpenCV and ROS have no double sphere.
  EXPECT_EQ(written, 15 - 4);
}

TEST(OpencvExport, FileStorageReadsIt) {
  Example e = with_camera("pinhole_radtan", {-0.1, 0.05, 1e-4, -2e-4, 0.011});
  e.request.parent = "left_camera_optical";
  e.request.children = {"top"};
  const std::string text = exported(e.request, "opencv", "left.yaml");
  cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::Mat K, D, R, T;
  storage["camera_matrix"] >> K;
  storage["distortion_coefficients"] >> D;
  storage["R"] >> R;
  storage["T"] >> T;
  ASSERT_EQ(K.size(), cv::Size(3, 3));
  ASSERT_EQ(D.total(), 5u);
  const auto& p = e.request.calibration.cameras["left"].camera.parameters;
  EXPECT_EQ(K.at<double>(0, 0), p(0));
  EXPECT_EQ(K.at<double>(1, 1), p(1));
  EXPECT_EQ(K.at<double>(0, 2), p(2));
  EXPECT_EQ(K.at<double>(1, 2), p(3));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(D.at<double>(i), p(4 + i));
  EXPECT_EQ(static_cast<int>(storage["image_width"]), 640);
  EXPECT_EQ(static_cast<std::string>(storage["parent_frame"]), "left_camera_optical");
  EXPECT_EQ(static_cast<std::string>(storage["child_frame"]), "top_lidar");
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(T.at<double>(i), e.T_left_top.t(i), 1e-9);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(R.at<double>(i, k), e.T_left_top.R(i, k), 1e-9);
  }
}

TEST(OpencvExport, SeveralLidarsAreAList) {
  const Example e = example();
  cv::FileStorage storage(exported(e.request, "opencv", "right.yaml"),
                          cv::FileStorage::READ | cv::FileStorage::MEMORY);
  EXPECT_EQ(static_cast<int>(storage["fisheye_model"]), 1);
  EXPECT_TRUE(storage["R"].empty());
  const cv::FileNode list = storage["transforms"];
  ASSERT_EQ(list.size(), 2u);
  for (const cv::FileNode node : list) {
    cv::Mat T;
    node["T"] >> T;
    const Pose& T_left_lidar =
        static_cast<std::string>(node["child_frame"]) == "top_lidar" ? e.T_left_top : e.T_left_side;
    const Pose truth = e.T_left_right.inverse() * T_left_lidar;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(T.at<double>(i), truth.t(i), 1e-9);
  }
}

/// Numbers of a YAML sequence against ours.
void expect_numbers(const YAML::Node& list, const std::vector<double>& expected) {
  ASSERT_EQ(list.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(list[i].as<double>(), expected[i], 1e-9) << i;
}

TEST(CameraInfoExport, HasTheKeysAndNumbersOfRos) {
  const Example e = example();
  const YAML::Node left = YAML::Load(exported(e.request, "camera_info", "left.yaml"));
  const std::vector<double> l = parameters(e.request.calibration.cameras.at("left").camera);
  expect_numbers(left["camera_matrix"]["data"], {l[0], 0, l[2], 0, l[1], l[3], 0, 0, 1});
  expect_numbers(left["distortion_coefficients"]["data"], {l[4], l[5], l[6], l[7], l[8]});
  expect_numbers(left["rectification_matrix"]["data"], {1, 0, 0, 0, 1, 0, 0, 0, 1});
  expect_numbers(left["projection_matrix"]["data"], {l[0], 0, l[2], 0, 0, l[1], l[3], 0, 0, 0, 1, 0});
  EXPECT_EQ(left["camera_name"].as<std::string>(), "left");
  EXPECT_EQ(left["distortion_model"].as<std::string>(), "plumb_bob");
  EXPECT_EQ(left["distortion_coefficients"]["data"].size(), 5u);
  EXPECT_EQ(left["camera_matrix"]["data"].size(), 9u);
  EXPECT_EQ(left["rectification_matrix"]["data"].size(), 9u);
  EXPECT_EQ(left["projection_matrix"]["cols"].as<int>(), 4);
  EXPECT_EQ(left["projection_matrix"]["data"][2].as<double>(), left["camera_matrix"]["data"][2].as<double>());
  const YAML::Node right = YAML::Load(exported(e.request, "camera_info", "right.yaml"));
  EXPECT_EQ(right["distortion_model"].as<std::string>(), "equidistant");
  const std::vector<double> r = parameters(e.request.calibration.cameras.at("right").camera);
  expect_numbers(right["camera_matrix"]["data"], {r[0], 0, r[2], 0, r[1], r[3], 0, 0, 1});
  expect_numbers(right["distortion_coefficients"]["data"], {r[4], r[5], r[6], r[7]});
}

TEST(CameraInfoExport, RefusesPosesAndSizesItCannotHave) {
  Example e = example();
  e.request.children = {"top"};
  auto files = find_exporter("camera_info")->write(e.request);
  ASSERT_FALSE(files);
  EXPECT_EQ(files.error().code, ErrorCode::refused);
  e.request.children.clear();
  e.request.calibration.cameras["right"].camera.width = 0;
  files = find_exporter("camera_info")->write(e.request);
  ASSERT_FALSE(files);
  EXPECT_NE(files.error().text().find("right"), std::string::npos);
}

TEST(KalibrExport, ChainAndLidars) {
  Example e = example();
  const auto matrix = [](const YAML::Node& rows) {
    Pose T;
    for (int i = 0; i < 3; ++i) {
      T.t(i) = rows[i][3].as<double>();
      for (int k = 0; k < 3; ++k) T.R(i, k) = rows[i][k].as<double>();
    }
    for (int k = 0; k < 4; ++k) EXPECT_EQ(rows[3][k].as<int>(), k == 3);
    return T;
  };
  YAML::Node chain = YAML::Load(exported(e.request, "kalibr", "camchain.yaml"));
  EXPECT_EQ(chain["cam0"]["distortion_model"].as<std::string>(), "radtan");
  EXPECT_EQ(chain["cam0"]["cam_overlaps"][0].as<int>(), 1);
  EXPECT_EQ(chain["cam1"]["distortion_model"].as<std::string>(), "equidistant");
  const std::vector<double> r = parameters(e.request.calibration.cameras.at("right").camera);
  expect_numbers(chain["cam1"]["intrinsics"], {r[0], r[1], r[2], r[3]});
  expect_numbers(chain["cam1"]["distortion_coeffs"], {r[4], r[5], r[6], r[7]});
  expect_same(matrix(chain["cam1"]["T_cn_cnm1"]), e.T_left_right.inverse());
  expect_same(matrix(chain["cam0"]["T_cam_side_lidar"]), e.T_left_side);
  expect_same(matrix(chain["cam1"]["T_cam_top_lidar"]), e.T_left_right.inverse() * e.T_left_top);
  EXPECT_FALSE(chain["cam0"]["T_cam_lidar"]) << "which of the two?";
  e.request.children = {"top"};
  chain = YAML::Load(exported(e.request, "kalibr", "camchain.yaml"));
  expect_same(matrix(chain["cam0"]["T_cam_lidar"]), e.T_left_top);
}

}  // namespace
}  // namespace ca2
