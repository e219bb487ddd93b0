/// @file Formats of transforms, read back by what reads them on a robot: a shell, a Python launch file run,
/// XML and YAML by libraries that the exporters do not use for writing numbers.
#include <yaml-cpp/yaml.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "tests/core/export/example.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

using namespace test;

/// What a publisher got: by child frame.
struct Published {
  std::string parent;
  Pose T;
};
using Tree = std::map<std::string, Published>;

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string run(const std::string& command) {
  std::string output;
  FILE* pipe = ::popen(command.c_str(), "r");
  char block[4096];
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, pipe)) > 0;) output.append(block, n);
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return output;
}

/// Options --x .. --child-frame-id of ROS 2's static_transform_publisher.
void publish(Tree& tree, const std::vector<std::string>& words) {
  std::map<std::string, std::string> option;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) option[words[i]] = words[i + 1];
  ASSERT_EQ(option.size(), 9u);
  const auto number = [&](const char* name) { return std::stod(option.at(name)); };
  const double w = number("--qw");
  EXPECT_GE(w, 0);
  tree[option.at("--child-frame-id")] = {
      option.at("--frame-id"),
      {quaternion_rotation(number("--qx"), number("--qy"), number("--qz"), w),
       {number("--x"), number("--y"), number("--z")}}};
}

std::vector<std::string> split(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

void expect_rig(const Tree& tree, const Example& e) {
  ASSERT_EQ(tree.size(), 3u);
  for (const auto& [child, published] : tree) EXPECT_EQ(published.parent, "left_camera_optical");
  expect_same(tree.at("top_lidar").T, e.T_left_top);
  expect_same(tree.at("side_lidar").T, e.T_left_side);
  expect_same(tree.at("right_camera_optical").T, e.T_left_right);
}

TEST(RosExport, TheShellRunsTheCommands) {
  const TemporaryDirectory folder;
  std::filesystem::create_directory(folder / "bin");
  write(folder / "bin/ros2", "#!/bin/sh\necho \"$@\" >> " + (folder / "log").string() + "\n");
  std::filesystem::permissions(folder / "bin/ros2", std::filesystem::perms::all);
  for (int i = 0; i < example_poses; ++i) {
    const Example e = example(i);
    write(folder / "run.sh", exported(e.request, "ros", "static_transforms.sh") + "wait\n");
    std::filesystem::remove(folder / "log");
    run("PATH=" + (folder / "bin").string() + ":$PATH sh " + (folder / "run.sh").string());
    std::ifstream log(folder / "log");
    Tree tree;
    for (std::string line; std::getline(log, line);) {
      std::vector<std::string> words = split(line);
      ASSERT_GT(words.size(), 3u);
      EXPECT_EQ(words[0] + words[1] + words[2], "runtf2_rosstatic_transform_publisher");
      publish(tree, {words.begin() + 3, words.end()});
    }
    expect_rig(tree, e);
  }
}

TEST(RosExport, PythonRunsTheLaunchFile) {
  if (std::system("python3 -c '' 2>/dev/null") != 0) GTEST_SKIP() << "there is no python3";
  const TemporaryDirectory folder;
  std::filesystem::create_directories(folder / "launch_ros");
  write(folder / "launch.py", "def LaunchDescription(actions): return actions\n");
  write(folder / "launch_ros/__init__.py", "");
  write(folder / "launch_ros/actions.py", "def Node(**arguments): return arguments\n");
  const Example e = example();
  write(folder / "transforms.py", exported(e.request, "ros", "static_transforms.launch.py"));
  write(folder / "print.py",
        "import json, transforms\nprint(json.dumps(transforms.generate_launch_description()))\n");
  const auto nodes = nlohmann::json::parse(run("python3 " + (folder / "print.py").string()));
  Tree tree;
  for (const auto& node : nodes) {
    EXPECT_EQ(node["package"], "tf2_ros");
    EXPECT_EQ(node["executable"], "static_transform_publisher");
    publish(tree, node["arguments"]);
  }
  expect_rig(tree, e);
}

TEST(RosExport, LaunchFilesOfBothGenerations) {
  const Example e = example();
  for (const bool ros1 : {false, true}) {
    pugi::xml_document document;
    const std::string text =
        exported(e.request, "ros", ros1 ? "static_transforms_ros1.launch" : "static_transforms.launch.xml");
    ASSERT_TRUE(document.load_string(text.c_str())) << text;
    Tree tree;
    for (const auto node : document.child("launch").children("node")) {
      EXPECT_STREQ(node.attribute(ros1 ? "type" : "exec").value(), "static_transform_publisher");
      const std::vector<std::string> words = split(node.attribute("args").value());
      if (!ros1) {
        publish(tree, words);
        continue;
      }
      ASSERT_EQ(words.size(), 9u);
      double n[7];
      for (std::size_t i = 0; i < 7; ++i) n[i] = std::stod(words[i]);
      tree[words[8]] = {words[7], {quaternion_rotation(n[3], n[4], n[5], n[6]), {n[0], n[1], n[2]}}};
    }
    expect_rig(tree, e);
  }
}

TEST(UrdfExport, FixedJointsGiveThePosesAlsoAtThePole) {
  for (int i = 0; i < example_poses; ++i) {
    const Example e = example(i);
    pugi::xml_document document;
    const std::string text = exported(e.request, "urdf", "calibration.urdf");
    ASSERT_TRUE(document.load_string(text.c_str())) << text;
    const auto robot = document.child("robot");
    Tree tree;
    std::set<std::string> links;
    for (const auto link : robot.children("link")) links.insert(link.attribute("name").value());
    for (const auto joint : robot.children("joint")) {
      EXPECT_STREQ(joint.attribute("type").value(), "fixed");
      const auto xyz = split(joint.child("origin").attribute("xyz").value());
      const auto rpy = split(joint.child("origin").attribute("rpy").value());
      ASSERT_EQ(xyz.size() + rpy.size(), 6u);
      tree[joint.child("child").attribute("link").value()] = {
          joint.child("parent").attribute("link").value(),
          {urdf_rotation(std::stod(rpy[0]), std::stod(rpy[1]), std::stod(rpy[2])),
           {std::stod(xyz[0]), std::stod(xyz[1]), std::stod(xyz[2])}}};
    }
    expect_rig(tree, e);
    EXPECT_EQ(links, (std::set<std::string>{"left_camera_optical", "right_camera_optical", "side_lidar",
                                            "top_lidar"}));
    EXPECT_EQ(text.find("as a quaternion") != std::string::npos, i >= 20 && i <= 35) << i;
  }
}

TEST(AutowareExport, LinksOfCamerasUnderTheFirstLidar) {
  Eigen::Matrix3d R_link_optical;  // x right, y down, z forward in x forward, y left, z up
  R_link_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (int i = 0; i < example_poses; ++i) {
    const Example e = example(i);
    const YAML::Node root = YAML::Load(exported(e.request, "autoware", "sensor_kit_calibration.yaml"));
    ASSERT_EQ(root.size(), 1u);
    const YAML::Node kit = root["side_lidar"];
    const auto pose = [&](const char* child) {
      const YAML::Node n = kit[child];
      return Pose{urdf_rotation(n["roll"].as<double>(), n["pitch"].as<double>(), n["yaw"].as<double>()),
                  {n["x"].as<double>(), n["y"].as<double>(), n["z"].as<double>()}};
    };
    ASSERT_EQ(kit.size(), 3u);
    const Pose T_side_left = e.T_left_side.inverse();
    const Pose T_optical_link{R_link_optical.transpose(), Eigen::Vector3d::Zero()};
    expect_same(pose("top_lidar"), T_side_left * e.T_left_top);
    expect_same(pose("left_camera_link"), T_side_left * T_optical_link);
    expect_same(pose("right_camera_link"), T_side_left * e.T_left_right * T_optical_link);
  }
}

TEST(JsonExport, HasBothDirectionsTheCovarianceAndWhatItRestsOn) {
  const Example e = example();
  const auto json = nlohmann::json::parse(exported(e.request, "json", "calibration.json"));
  const auto pose = [](const nlohmann::json& j) {
    const auto &q = j["rotation"], &t = j["translation"];
    return Pose{quaternion_rotation(q["qx"], q["qy"], q["qz"], q["qw"]),
                Eigen::Vector3d(t["x"].get<double>(), t["y"].get<double>(), t["z"].get<double>())};
  };
  int seen = 0;
  for (const auto& t : json["transforms"]) {
    EXPECT_EQ(t["parent_frame"], "left_camera_optical");
    const Pose& truth = t["child_frame"] == "top_lidar"    ? e.T_left_top
                        : t["child_frame"] == "side_lidar" ? e.T_left_side
                                                           : e.T_left_right;
    expect_same(pose(t), truth);
    expect_same(pose(t["inverse"]), truth.inverse());
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(t["matrix_row_major"][4 * i + 3], truth.t(i), 1e-9);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(t["matrix_row_major"][4 * i + k], truth.R(i, k), 1e-9);
    }
    EXPECT_EQ(t["covariance"].size(), 36u);
    EXPECT_EQ(t["covariance"][7], 1e-6);
    ++seen;
  }
  EXPECT_EQ(seen, 3);
  EXPECT_EQ(json["provenance"]["lidars.top.serial"], "122");
  EXPECT_EQ(json["calibration"]["views"].size(), 2u);
}

TEST(TransformExports, RefuseNamesThatDoNotSurvive) {
  for (const char* name : {"a b", "/camera", "a'b", "a\"b", "a$b", "a;b", "a\nb"}) {
    Example e = example();
    for (CalibratedTransform& t : e.request.calibration.transforms) {
      if (t.child == "top") t.child_frame = name;
    }
    e.request.frames = *FrameGraph::of(e.request.calibration);
    for (const char* format : {"ros", "urdf", "autoware"}) {
      const auto files = find_exporter(format)->write(e.request);
      ASSERT_FALSE(files) << format << " " << name;
      EXPECT_EQ(files.error().code, ErrorCode::refused);
    }
  }
}

}  // namespace
}  // namespace ca2
