/// @file `ca2 export` as a person runs it, against the simulator's truth.
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <pugixml.hpp>
#include <regex>
#include <sstream>

#include "tests/tools/ca2/small_session.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class ExportCommand : public SmallSession {
 protected:
  void SetUp() override {
    SmallSession::SetUp();
    ASSERT_EQ(solve().status, 0);
    const auto truth = read_true_transforms(session / "truth.yaml");
    ASSERT_TRUE(truth);
    T_front_puck = truth->front().T_parent_child;
  }

  Outcome run(const std::string& format, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{"export", session, "--format", format};
    words.insert(words.end(), options.begin(), options.end());
    return run_ca2(words);
  }

  /// As the calibration is: a few mm and mrad.
  static void expect_near(const Pose& found, const Pose& truth) {
    const Vector6d error = truth.difference(found);
    EXPECT_LT(error.tail<3>().norm(), 0.005);
    EXPECT_LT(error.head<3>().norm(), 0.002);
  }

  Pose T_front_puck;
};

/// The options of the one publisher in a text.
Pose published(const std::string& text, std::string& parent, std::string& child) {
  std::istringstream stream(text.substr(text.find("--x")));
  std::map<std::string, std::string> option;
  for (std::string name, value; stream >> name >> value;) option[name] = value;
  parent = option["--frame-id"];
  child = option["--child-frame-id"];
  const auto n = [&](const char* name) { return std::stod(option.at(name)); };
  return Pose::from_quaternion({n("--qw"), n("--qx"), n("--qy"), n("--qz")}, {n("--x"), n("--y"), n("--z")});
}

TEST_F(ExportCommand, RosPublishesTheTrueTransform) {
  const Outcome ros = run("ros");
  ASSERT_EQ(ros.status, 0) << ros.errors;
  EXPECT_EQ(ros.errors, "");
  std::string parent, child;
  const Pose T = published(ros.output, parent, child);
  EXPECT_EQ(parent, "front_camera_optical");
  EXPECT_EQ(child, "velodyne");
  expect_near(T, T_front_puck);
}

TEST_F(ExportCommand, ReplacesNothingThatItWasMadeOf) {
  const fs::path robot = folder / "robot.urdf";
  const std::string text =
      R"(<robot name="r"><link name="base"/><link name="mount"/><joint name="j" type="fixed"><parent link="base"/>)"
      R"(<child link="mount"/><origin xyz="0.1 0.2 0.3"/></joint></robot>)";
  write_bytes(robot, text);
  const auto refused = [&](const std::string& format, const std::vector<std::string>& options) {
    const Outcome outcome = run(format, options);
    EXPECT_EQ(outcome.status, 73) << outcome.output;
    EXPECT_NE(outcome.errors.find("is what this is made of; --output names another file"), std::string::npos)
        << outcome.errors;
  };
  refused("urdf", {"--via", robot, "--output", robot});
  EXPECT_EQ(bytes_of(robot), text);
  const std::string answer = bytes_of(result()), rig = bytes_of(session / "session.yaml");
  refused("json", {"--output", result()});
  refused("camera_info", {"--output", session / "session.yaml"});
  EXPECT_EQ(solve({"--output", session / "session.yaml"}).status, 73);
  EXPECT_EQ(solve({"--output", picture(1)}).status, 73);
  EXPECT_EQ(run_ca2({"intrinsics", session, "--output", session / "session.yaml"}).status, 73);
  EXPECT_EQ(bytes_of(result()), answer);
  EXPECT_EQ(bytes_of(session / "session.yaml"), rig);
}

/// A directory to write to may be the session's own, and hold the intrinsics that the rig was given.
TEST_F(ExportCommand, ReplacesNoIntrinsicsThatTheRigNames) {
  ASSERT_EQ(run("camera_info", {"--output", session}).status, 0);
  const std::string given = bytes_of(session / "front.yaml");
  std::string rig = bytes_of(session / "session.yaml");
  const std::size_t begin = rig.find("    intrinsics:"), end = rig.find('\n', begin);
  ASSERT_NE(begin, std::string::npos);
  write_bytes(session / "session.yaml", rig.replace(begin, end - begin, "    file: front.yaml"));
  const Outcome again = run("camera_info", {"--output", session});
  EXPECT_EQ(again.status, 73) << again.errors;
  EXPECT_NE(again.errors.find("front.yaml: is what this is made of"), std::string::npos) << again.errors;
  EXPECT_EQ(bytes_of(session / "front.yaml"), given);
  const Outcome inputs = run("json");
  for (const char* file : {"session.yaml", "front.yaml", "views/000001/front.png"}) {
    const std::regex hashed("\"" + std::string(file) + "\": \"sha256 [0-9a-f]{64}\"");
    EXPECT_TRUE(std::regex_search(inputs.output, hashed)) << inputs.output;
  }
}

TEST_F(ExportCommand, ComposesThroughCameraLinkAndAFile) {
  // REP 103: a link looks along x; its optical frame is turned by roll -90, pitch 0, yaw -90 degrees.
  const Pose T_link_optical = Pose::from_quaternion(Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5), {0, 0, 0});
  write_bytes(folder / "robot.yaml",
              "extrinsics:\n- {parent: base_link, child: mount, translation: [0.1, 0.2, 0.3],"
              " rotation: {x: 0, y: 0, z: 0, w: 1}}\n");
  const Pose T_base_mount{Eigen::Matrix3d::Identity(), {0.1, 0.2, 0.3}};
  struct Case {
    std::vector<std::string> options;
    Pose truth;  ///< T_parent_child
  };
  const std::vector<Case> cases{
      {{"--parent", "puck", "--child", "front_camera_link"},
       T_front_puck.inverse() * T_link_optical.inverse()},
      {{"--parent", "velodyne", "--child", "eye", "--via", "front"},
       T_front_puck.inverse() * T_link_optical.inverse()},
      {{"--parent", "base_link", "--child", "puck", "--via", folder / "robot.yaml", "--via", "mount=front"},
       T_base_mount * T_link_optical * T_front_puck},
  };
  for (const Case& c : cases) {
    const Outcome ros = run("ros", c.options);
    ASSERT_EQ(ros.status, 0) << ros.errors;
    std::string parent, child;
    expect_near(published(ros.output, parent, child), c.truth);
    EXPECT_EQ(parent, c.options[1] == "puck" ? "velodyne" : c.options[1]);
  }
}

TEST_F(ExportCommand, EveryFormatWritesFilesThatAreRead) {
  for (const char* format : {"ros", "urdf", "camera_info", "kalibr", "opencv", "autoware", "json"}) {
    const fs::path output = folder / format;
    const Outcome written = run(format, {"--output", output});
    ASSERT_EQ(written.status, 0) << format << ": " << written.errors;
    EXPECT_FALSE(fs::is_empty(output));
    for (const auto& file : fs::directory_iterator(output)) {
      EXPECT_NE(written.output.find(file.path().string()), std::string::npos) << "the paths are printed";
      EXPECT_GT(fs::file_size(file), 100u);
    }
    const Outcome printed = run(format);
    EXPECT_EQ(printed.status, 0);
    EXPECT_FALSE(printed.output.empty());
  }
  pugi::xml_document urdf;
  ASSERT_TRUE(urdf.load_file((folder / "urdf/calibration.urdf").c_str()));
  EXPECT_TRUE(urdf.child("robot").child("joint"));
  const YAML::Node camera = YAML::LoadFile(folder / "camera_info/front.yaml");
  EXPECT_NEAR(camera["camera_matrix"]["data"][0].as<double>(), 518, 3);
  EXPECT_NE(bytes_of(folder / "json/calibration.json").find("sha256 "), std::string::npos);
  const Outcome single = run("urdf", {"-o", folder / "robot.urdf"});
  ASSERT_EQ(single.status, 0) << single.errors;
  EXPECT_EQ(bytes_of(folder / "robot.urdf"), bytes_of(folder / "urdf/calibration.urdf"));
}

TEST_F(ExportCommand, MistakesSayWhatToDo) {
  struct Case {
    std::vector<std::string> options;
    int status;
    const char* word;
  };
  write_bytes(folder / "wrong.yaml",
              "extrinsics:\n- {parent: front, child: puck, translation: [1, 0, 0], rotation: {x: 0, y: 0, z: "
              "0, w: 1}}\n");
  const std::vector<Case> cases{
      {{"--format", "ros", "--parent", "base_link"}, 64, "known are"},
      {{"--format", "ros", "--via", "nothing"}, 64, "neither a file"},
      {{"--format", "ros", "--parent", "puck", "--child", "puck"}, 64, "both parent and child"},
      {{"--format", "ros", "--via", folder / "wrong.yaml"}, 78, "take out the transform"},
      {{"--format", "camera_info", "--child", "puck"}, 1, "cannot express"},
      {{"--format", "opencv", "--parent", "puck"}, 1, "no camera"},
      {{"--format", "nonsense"}, 64, "nonsense"},
      {{}, 64, "--format"},
      {{"--format", "urdf", "--output", "/proc/nowhere/x"}, 73, "/proc/nowhere"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> words{"export", session};
    words.insert(words.end(), c.options.begin(), c.options.end());
    const Outcome outcome = run_ca2(words);
    EXPECT_EQ(outcome.status, c.status) << outcome.errors;
    EXPECT_NE(outcome.errors.find(c.word), std::string::npos) << outcome.errors;
    EXPECT_EQ(outcome.output, "");
  }
  fs::remove(result());
  const Outcome unsolved = run("ros");
  EXPECT_EQ(unsolved.status, 65);
  EXPECT_NE(unsolved.errors.find("ca2 solve"), std::string::npos);
}

}  // namespace
}  // namespace ca2
