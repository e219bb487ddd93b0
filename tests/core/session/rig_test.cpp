#include "core/session/rig.h"

#include <gtest/gtest.h>

#include <random>

#include "core/io/files.h"
#include "tests/core/session/rig_text.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

using test::rig_text;

/// The rig text with one place changed.
std::string with(const std::string& from, const std::string& to) {
  std::string text = rig_text;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  const auto rig = parse_rig(text, "rig.yaml");
  if (rig) return "no error";
  EXPECT_EQ(rig.error().code, ErrorCode::config);
  for (const Problem& problem : rig.error().problems) EXPECT_FALSE(problem.where.empty());
  return rig.error().text();
}

void expect_error(const std::string& text, const std::string& expected) {
  EXPECT_NE(error_of(text).find(expected), std::string::npos)
      << "expected: " << expected << "\nfound: " << error_of(text);
}

TEST(Rig, ReadsEverything) {
  const auto rig = parse_rig(rig_text, "rig.yaml");
  ASSERT_TRUE(rig) << rig.error().text();
  EXPECT_EQ(rig->board.type->name(), "checkerboard");
  EXPECT_EQ(rig->board.columns, 8);
  EXPECT_EQ(rig->board.outline->center, Eigen::Vector2d(0.001, -0.002));
  const RigCamera& left = rig->cameras.at("left");
  EXPECT_EQ(left.frame, "left_camera_optical");
  EXPECT_EQ(left.width, 1388);
  EXPECT_EQ(left.intrinsics->parameters[3], 520.4);
  EXPECT_EQ(left.intrinsics->height, 1038);
  EXPECT_EQ(left.source.at("id"), "Allied Vision-50-0503");
  EXPECT_EQ(rig->cameras.at("right").model, "kannala_brandt");
  EXPECT_EQ(rig->cameras.at("right").frame, "right");
  EXPECT_FALSE(rig->cameras.at("right").intrinsics);
  EXPECT_EQ(rig->lidars.at("top").source.at("port"), "7502");
  EXPECT_EQ(rig->lidars.at("front").model, "VLP-16");
  ASSERT_EQ(rig->extrinsics.size(), 2u);
  EXPECT_FALSE(rig->extrinsics[0].fixed);
  EXPECT_TRUE(rig->extrinsics[1].fixed);
  // By the textbook formula from x: 0.5, y: -0.5, z: 0.5, w: 0.5.
  Eigen::Matrix3d R;
  R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  EXPECT_TRUE(rig->extrinsics[0].T_parent_child.R.isApprox(R, 1e-15)) << rig->extrinsics[0].T_parent_child.R;
}

TEST(Rig, RoundTripsBitForBit) {
  const Rig rig = parse_rig(rig_text, "rig.yaml").value();
  const std::string text = write_rig(rig);
  const auto again = parse_rig(text, "again.yaml");
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(write_rig(*again), text);
  EXPECT_EQ(again->cameras.at("left").intrinsics->parameters, rig.cameras.at("left").intrinsics->parameters);
  EXPECT_EQ(again->cameras.at("left").source, rig.cameras.at("left").source);
  EXPECT_EQ(again->board.square, rig.board.square);
}

TEST(Rig, AnyRotationRoundTripsBitForBit) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Rig rig = parse_rig(rig_text, "rig.yaml").value();
  for (int i = 0; i < 2000; ++i) {
    Pose& pose = rig.extrinsics[0].T_parent_child;
    pose = Pose::from_quaternion({normal(random), normal(random), normal(random), normal(random)},
                                 {normal(random), normal(random), normal(random)});
    const Rig once = parse_rig(write_rig(rig), "rig.yaml").value();
    EXPECT_TRUE(once.extrinsics[0].T_parent_child.R.isApprox(pose.R, 1e-13));
    EXPECT_EQ(once.extrinsics[0].T_parent_child.t, pose.t);
    const Rig twice = parse_rig(write_rig(once), "rig.yaml").value();
    ASSERT_EQ(once.extrinsics[0].T_parent_child.R, twice.extrinsics[0].T_parent_child.R) << i;
  }
}

TEST(Rig, EveryProblemHasItsPlaceAndAHint) {
  expect_error(with("version: 1\n", ""), "the file has no key 'version'");
  expect_error(with("version: 1", "version: 2"), "rig.yaml:1:10: version 2 is not known");
  expect_error(with("columns: 8", "colums: 8"),
               "rig.yaml:4:3: unknown key 'colums' in board; did you mean 'columns'?");
  expect_error(with("columns: 8", "columns: eight"),
               "rig.yaml:4:12: 'columns' must be a whole number, not 'eight'");
  expect_error(with("columns: 8", "columns: 99999999999999999999"),
               "rig.yaml:4:12: 'columns' must be from 1 to 1000");
  expect_error(with("columns: 8", "columns: 2"), "rig.yaml:3:3: ");
  expect_error(with("square: 0.040", "square: .nan"), "rig.yaml:6:11: 'square' must be a finite number");
  expect_error(with("square: 0.040", "square: 1e999"), "'square' must be a finite number");
  expect_error(with("square: 0.040", "square: -1"), "'square' must be from");
  expect_error(with("square: 0.040", "square: \"0.04\""), "'square' must be a number");
  expect_error(with("type: checkerboard", "type: checkersboard"),
               "there is no board type 'checkersboard'; did you mean 'checkerboard'?");
  expect_error(with("pinhole_radtan", "pinhole_radtam"),
               "rig.yaml:12:25: there is no camera model 'pinhole_radtam'; did you mean");
  expect_error(with("[1000.1, 1001.2,", "[1000.1,"), "no error");  // 8 are allowed: k3 may be left out
  expect_error(with("[1000.1, 1001.2, 690.3,", "["),
               "pinhole_radtan takes 8 or 9 parameters, not 6; in this order: fx fy cx cy k1 k2 p1 p2 [k3]");
  expect_error(with("[1000.1,", "[-1000.1,"), "this is no pinhole_radtan camera: ");
  expect_error(with("[1388, 1038]", "[1388]"), "image_size must be [width, height]");
  expect_error(with("[1388, 1038]", "[0, 1038]"), "must be from 1 to 30000");
  expect_error(with("  left:", "  ../left:"), "rig.yaml:9:3: a sensor's name must be");
  expect_error(with("  top:", "  left:"), "rig.yaml:17:3: there is a camera named 'left' already");
  expect_error(with("  top:\n", "  left:\n"), "unique over cameras and lidars");
  expect_error(with("child: top", "child: tip"), "there is no sensor 'tip'; did you mean 'top'?");
  expect_error(with("child: top", "child: left"), "parent and child are the same");
  expect_error(with("child: right", "child: top"), "there is an extrinsic between left and top already");
  expect_error(with("w: 0.5}", "w: 0.6}"), "the quaternion has the length 1.0");
  expect_error(with("{x: 0.5,", "{"), "rotation has no key 'x'");
  expect_error(with("[0.1, -0.2, 0.3]", "[0.1, -0.2]"),
               "'translation' must be a list of 3 numbers, not of 2");
  expect_error(with("[0.1, -0.2, 0.3]", "[0.1, -0.2, 1e300]"), "must be from -10000 to 10000");
  expect_error(with("fixed: true", "fixed: yes"), "'fixed' must be true or false");
  expect_error(with("port: 7502", "port: [1]"), "'port' must be a single value");
  expect_error(with("frame: top_lidar", "frame: [a]"), "'frame' must be a text");
  expect_error("version: 1\nboard: {type: checkerboard, columns: 8, rows: 5, square: 0.04}\n",
               "neither cameras nor lidars");
  expect_error("", "is empty");
  expect_error("just words", "must be a mapping");
  expect_error("[1, 2]", "must be a mapping");
}

TEST(Rig, MillimetresAreToldFromMetres) {
  expect_error(
      with("square: 0.040", "square: 40"),
      "rig.yaml:6:11: 'square' must be from 1e-04 to 10 m, not '40'; are these millimetres? Write 0.04");
  expect_error(with("width: 0.420", "width: 420"), "are these millimetres? Write 0.42");
  expect_error(with("height: 0.297", "height: 29700"), "must be from 0.001 to 10 m, not '29700'");
}

TEST(Rig, APlateThatThePrintDoesNotFitOnIsRefused) {
  const std::string words = "rig.yaml:7:12: the print, 0.360 x 0.240 m, does not fit on this plate of ";
  expect_error(with("width: 0.420, height: 0.297", "width: 0.297, height: 0.420"), words + "0.297 x 0.420 m");
  expect_error(with("center: [0.001, -0.002]", "center: [0.1, 0]"), words);
  expect_error(with("columns: 8\n  rows: 5", "columns: 5\n  rows: 8"),
               "the print, 0.240 x 0.360 m, does not fit");
  expect_error(with("width: 0.420, height: 0.297", "width: 0.330, height: 0.220"),
               "no error");  // cut through squares
}

TEST(Rig, AllProblemsAreReportedAtOnce) {
  std::string text = with("columns: 8", "colums: 8");
  text.replace(text.find("0.040"), 5, "wide");
  text.replace(text.find("pinhole_radtan"), 14, "fisheye");
  text.replace(text.find("child: top"), 10, "child: tip");
  const auto rig = parse_rig(text, "rig.yaml");
  ASSERT_FALSE(rig);
  EXPECT_EQ(rig.error().problems.size(), 5u) << rig.error().text();
}

TEST(Rig, ExtraKeysAreOfTheFile) {
  const std::string text = std::string(rig_text) + "start: 1700000000000000000\n";
  expect_error(text, "unknown key 'start'");
  EXPECT_TRUE(parse_rig(text, "recording.yaml", {"start"}));
}

TEST(Rig, AQuaternionAlmostOfUnitLengthIsNormalised) {
  const auto rig = parse_rig(with("w: 0.5}", "w: 0.5005}"), "rig.yaml");
  ASSERT_TRUE(rig) << rig.error().text();
  const Eigen::Matrix3d& R = rig->extrinsics[0].T_parent_child.R;
  EXPECT_TRUE((R * R.transpose()).isIdentity(1e-15));
}

TEST(Rig, IntrinsicsOfAFile) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(
      write_atomically(directory / "left.yaml",
                       "image_width: 640\nimage_height: 480\ncamera_name: left\n"
                       "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 320, 0, 501, 240, 0, 0, 1]}\n"
                       "distortion_model: plumb_bob\n"
                       "distortion_coefficients: {rows: 1, cols: 5, data: [-0.1, 0.01, 0, 0, 0]}\n"));
  const std::string inline_key = "intrinsics: {model: kannala_brandt}";
  for (const std::string form : {"file: left.yaml", "intrinsics: {file: left.yaml}"}) {
    const auto rig = parse_rig(with(inline_key, form), directory / "rig.yaml");
    ASSERT_TRUE(rig) << rig.error().text();
    const RigCamera& right = rig->cameras.at("right");
    EXPECT_EQ(right.width, 640);
    EXPECT_EQ(right.model, "pinhole_radtan");
    EXPECT_EQ(right.intrinsics->parameters[1], 501);
    EXPECT_EQ(right.intrinsics->height, 480);
    const auto clash =
        parse_rig(with(inline_key, form + "\n    image_size: [800, 600]"), directory / "rig.yaml");
    ASSERT_FALSE(clash);
    EXPECT_NE(clash.error().text().find("pictures of 640 x 480, image_size says 800 x 600"),
              std::string::npos);
  }
  const auto missing = parse_rig(with(inline_key, "file: none.yaml"), directory / "rig.yaml");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().text().find("none.yaml"), std::string::npos);
  expect_error(with(inline_key, inline_key + "\n    file: left.yaml"), "both 'file' and 'intrinsics'");
  expect_error(with(inline_key, "camera: cam0"), "'camera' needs a 'file'");
}

TEST(Rig, EveryTruncationIsAnErrorOrASmallerRig) {
  const std::string text = rig_text;
  for (std::size_t size = 0; size < text.size(); ++size) {
    const auto rig = parse_rig(text.substr(0, size), "rig.yaml");
    if (rig) continue;
    for (const Problem& problem : rig.error().problems) {
      ASSERT_EQ(problem.where.substr(0, 8), "rig.yaml") << size;
      ASSERT_FALSE(problem.what.empty());
    }
  }
}

}  // namespace
}  // namespace ca2
