#include "core/session/calibration.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "core/io/files.h"
#include "core/io/yaml.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

Calibration example() {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Calibration c;
  c.software = "ca2 0.1.0";
  c.method = "joint";
  for (const char* child : {"top", "front"}) {
    CalibratedTransform t;
    t.parent = "left";
    t.child = child;
    t.parent_frame = "left_camera_optical";
    t.child_frame = std::string(child) + "_lidar";
    t.T_parent_child = Pose::from_quaternion({0.5, -0.5, 0.5, -0.5000001}, {0.1, -1.0 / 3, 2e-17});
    Matrix6d root;
    for (double& value : root.reshaped()) value = 1e-3 * normal(random);
    t.covariance = root * root.transpose();
    t.covariance = 0.5 * (t.covariance + t.covariance.transpose()).eval();
    c.transforms.push_back(t);
  }
  CalibratedCamera camera;
  camera.camera.model = find_camera_model("pinhole_radtan");
  camera.camera.parameters.resize(8);
  camera.camera.parameters << 1000.0 / 3, 1001, 640, 360, -0.1, 0.01, 1e-4, -1e-5;
  camera.camera.width = 1280;
  camera.camera.height = 720;
  camera.estimated = true;
  camera.sigma = {0.1, 0.2, 0.3, 0.4, 0, 0, 0, 0};
  c.cameras["left"] = camera;
  c.lidars["top"] = {0.003, 0.001, 0.011, true};
  c.lidars["front"] = {};
  c.print = {{0.0021, -0.0017}, {0.0004, 0.0005}, true};
  c.observability = {"good", "rotation about the board's vertical: \"yaw\" #1\nsecond line", 12.3};
  c.validation = {0.0012, 0.0008, 0.0021, 0.11, 0.012};
  c.views = {{1, true, "", 0.1, 0.011}, {2, false, "the board's plane: 35 mm off, 9 sigma", 0.3, 0.035}};
  c.notes = {"the plates' outlines: \"left out\"", "second"};
  c.inputs = {{{"board", "0123456789012345"}, {"cameras.left", "00000000000001e5"}},
              {{1, {{"left", "ffffffffffffffff"}, {"top", "none"}}}, {2, {}}}};
  return c;
}

TEST(Calibration, RoundTrips) {
  const test::TemporaryDirectory directory;
  const Calibration c = example();
  ASSERT_TRUE(write_atomically(directory / "result.yaml", to_yaml(c)));
  const auto read = read_calibration(directory / "result.yaml");
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->software, c.software);
  EXPECT_EQ(read->method, c.method);
  EXPECT_EQ(read->print.stretch, c.print.stretch);
  EXPECT_EQ(read->print.sigma, c.print.sigma);
  EXPECT_TRUE(read->print.estimated);
  ASSERT_EQ(read->transforms.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const CalibratedTransform &a = read->transforms[i], &b = c.transforms[i];
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_EQ(a.child, b.child);
    EXPECT_EQ(a.parent_frame, b.parent_frame);
    EXPECT_EQ(a.child_frame, b.child_frame);
    EXPECT_EQ(a.T_parent_child.t, b.T_parent_child.t);
    EXPECT_TRUE(a.T_parent_child.R.isApprox(b.T_parent_child.R, 1e-14));
    EXPECT_EQ(a.covariance, b.covariance);
  }
  EXPECT_EQ(read->cameras.at("left").camera.parameters, c.cameras.at("left").camera.parameters);
  EXPECT_EQ(read->cameras.at("left").camera.model, c.cameras.at("left").camera.model);
  EXPECT_EQ(read->cameras.at("left").camera.width, 1280);
  EXPECT_EQ(read->cameras.at("left").sigma, c.cameras.at("left").sigma);
  EXPECT_TRUE(read->cameras.at("left").estimated);
  EXPECT_EQ(read->lidars.at("top").range_bias, 0.003);
  EXPECT_TRUE(read->lidars.at("top").estimated);
  EXPECT_EQ(read->observability.weakest_direction, c.observability.weakest_direction);
  EXPECT_DOUBLE_EQ(read->validation.leave_one_out_translation, 0.0012);
  EXPECT_DOUBLE_EQ(read->validation.leave_one_out_rotation, 0.0008);
  EXPECT_DOUBLE_EQ(read->validation.outline_offset.value(), 0.0021);
  EXPECT_DOUBLE_EQ(read->validation.range_rms, 0.012);
  ASSERT_EQ(read->views.size(), 2u);
  EXPECT_EQ(read->views[0].reason, "");
  EXPECT_EQ(read->views[1].reason, c.views[1].reason);
  EXPECT_DOUBLE_EQ(read->views[1].plane_rms, 0.035);
  EXPECT_FALSE(read->views[1].used);
  EXPECT_EQ(read->notes, c.notes);
  ASSERT_TRUE(read->inputs);
  EXPECT_EQ(read->inputs->rig, c.inputs->rig);
  EXPECT_EQ(read->inputs->views, c.inputs->views);
}

TEST(Calibration, AnEmptyOneAndUnknownFiguresRoundTrip) {
  Calibration c;
  c.method = "kim";
  c.validation.range_rms = std::numeric_limits<double>::quiet_NaN();
  const auto read = parse_calibration(to_yaml(c), "result.yaml");
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_TRUE(read->transforms.empty());
  EXPECT_FALSE(read->inputs);
  EXPECT_FALSE(read->validation.outline_offset);
  EXPECT_TRUE(std::isnan(read->validation.range_rms));
  EXPECT_TRUE(nlohmann::json::parse(to_json(c))["validation"]["range_rms_mm"].is_null());
}

/// Keys in order, with their nesting: "a(b(c)d)".
std::string keys(const YamlNode& node) {
  std::string text;
  for (const YamlNode& item : node.items) text += item.key + "(" + keys(item) + ")";
  return text;
}
std::string keys(const nlohmann::ordered_json& json) {
  std::string text;
  for (const auto& [key, value] : json.items()) {
    text += (json.is_object() ? key : "") + "(" + (value.is_structured() ? keys(value) : "") + ")";
  }
  return text;
}

TEST(Calibration, YamlAndJsonHaveTheSameKeysAndTheUnitsOfTheFile) {
  const Calibration c = example();
  const YamlNode yaml = parse_yaml(to_yaml(c), "result.yaml").value();
  const auto json = nlohmann::ordered_json::parse(to_json(c));
  EXPECT_EQ(keys(yaml), keys(json));
  EXPECT_EQ(json["validation"]["leave_one_out"]["translation_mm"].get<double>(), 1.2);
  EXPECT_EQ(json["views"][1]["plane_rms_mm"].get<double>(), 35);
  EXPECT_EQ(json["transforms"][0]["covariance"][6].get<double>(), c.transforms[0].covariance(1, 0));
  const double trace = c.transforms[0].covariance.bottomRightCorner<3, 3>().trace();
  EXPECT_DOUBLE_EQ(json["transforms"][0]["sigma_translation_mm"].get<double>(), 1000 * std::sqrt(trace));
}

TEST(Calibration, DamagedResultsAreNamed) {
  const std::string text = to_yaml(example());
  const auto error_with = [&](const std::string& from, const std::string& to) -> std::string {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    const auto read = parse_calibration(changed, "result.yaml");
    if (read) return "no error";
    EXPECT_EQ(read.error().code, ErrorCode::data);
    return read.error().text();
  };
  EXPECT_NE(error_with("version: 1", "version: 7").find("result.yaml:1:10: version 7"), std::string::npos);
  EXPECT_NE(error_with("method: joint", "metod: joint").find("did you mean 'method'?"), std::string::npos);
  EXPECT_NE(error_with("covariance:\n      [", "covariance:\n      [1, ").find("36 numbers, not of 37"),
            std::string::npos);
  EXPECT_NE(error_with("covariance:\n      [", "covariance:\n      [-").find("no covariance"),
            std::string::npos);
  EXPECT_NE(error_with("w: 0.", "w: 1.").find("quaternion"), std::string::npos);
  EXPECT_NE(error_with("pinhole_radtan", "radtan").find("no camera model 'radtan'"), std::string::npos);
  EXPECT_NE(error_with("used: true", "used: maybe").find("true or false"), std::string::npos);
  EXPECT_NE(error_with("    2: {}", "    two: {}").find("'two' is no view's number"), std::string::npos);
  for (std::size_t size = 0; size < text.size(); size += 7) {
    parse_calibration(text.substr(0, size), "result.yaml");  // an error or not, but no crash
  }
  EXPECT_EQ(parse_calibration("", "r.yaml").error().text(), "r.yaml: is empty");
}

}  // namespace
}  // namespace ca2
