/// @file `ca2 bench stereo` on a simulated rig and on a session's files.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/temporary_directory.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;
using namespace ca2::test;

// Two cameras 120 mm apart under a VLP-16.
constexpr const char* scenario = R"(version: 1
seed: 6
board: {type: checkerboard, columns: 8, rows: 5, square: 0.088, outline: {width: 0.841, height: 0.594}}
cameras:
  left:
    image_size: [640, 480]
    intrinsics: {model: pinhole_radtan, parameters: [518, 517.5, 318, 243, -0.12, 0.09, 0, 0]}
  right:
    image_size: [640, 480]
    intrinsics: {model: pinhole_radtan, parameters: [516, 516.5, 321, 241, -0.11, 0.08, 0, 0]}
lidars:
  puck: {model: VLP-16}
truth:
  extrinsics:
    - {parent: left, child: puck, translation: [0.035, -0.137, -0.096], rotation: {x: 0.7193, y: 0.0034, z: -0.0149, w: 0.6945}}
    - {parent: left, child: right, translation: [0.12, 0, 0], rotation: {x: 0, y: 0, z: 0, w: 1}}
views: {count: 6, distance: [1.5, 2.5], tilt: [0.2, 0.9], roll: 0.7, min_rings: 5, min_returns: 80}
scene: {size: [7, 8, 3.0], rig_height: 1.1, furniture: 3}
noise:
  cameras: {sigma: 0.004, blur: 0.6}
  lidars: {range_sigma: 0.008, sweeps: 3}
)";

nlohmann::json bench(const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"bench", "stereo", "--json"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome run = run_ca2(arguments);
  EXPECT_EQ(run.status, 0) << run.errors;
  return run.status == 0 ? nlohmann::json::parse(run.output) : nlohmann::json::array();
}

double error(const nlohmann::json& row, const char* method, const char* what = "translation_mean_mm") {
  return row["methods"][method][what];
}

TEST(BenchStereo, SimulatedRigsBaselineIsFoundToAFractionOfAMillimetre) {
  const nlohmann::json rows =
      bench({"--data", CA2_SOURCE_DIR "/config/scenarios", "--only", "t265", "--trials", "6", "--seed", "3"});
  ASSERT_EQ(rows.size(), 7u);
  const nlohmann::json& last = rows.back();
  EXPECT_EQ(last["views"], 39);
  EXPECT_EQ(last["subsets"], 6);
  EXPECT_LT(error(last, "joint with edges"), 0.3);
  EXPECT_LT(error(last, "joint with edges"), 0.5 * error(last, "joint"));
  EXPECT_LT(error(last, "joint"), error(last, "plane_to_plane"));
  EXPECT_LT(error(last, "all at once"), 0.1);
  EXPECT_LT(error(last, "joint with edges", "rotation_mean_mrad"), 0.3);
  EXPECT_GT(error(last, "joint with edges", "translation_deviation_mm"), 0);
  // More views, less error, and less of it by chance.
  EXPECT_LT(error(last, "joint"), error(rows[2], "joint"));
  EXPECT_LT(error(last, "joint", "translation_deviation_mm"),
            error(rows[2], "joint", "translation_deviation_mm"));
}

TEST(BenchStereo, SessionIsHeldAgainstWhatIsKnownOfItsBaseline) {
  const TemporaryDirectory folder;
  const fs::path session = folder / "session";
  write_bytes(folder / "scenario.yaml", scenario);
  ASSERT_EQ(run_ca2({"simulate", folder / "scenario.yaml", "--output", session}).status, 0);
  const std::vector<std::string> options{"--data", session, "--trials", "4"};
  const auto of_five = [&] {
    const nlohmann::json rows = bench(options);
    EXPECT_EQ(rows.size(), 3u) << "3, 4 and 5 of six views";
    return rows.empty() ? nlohmann::json::object() : rows.back();
  };
  EXPECT_LT(error(of_five(), "joint with edges"), 5);
  EXPECT_LT(error(of_five(), "all at once"), 2);
  // Without the truth, what the rig says: 20 mm off.
  fs::remove(session / "truth.yaml");
  const std::string rig = bytes_of(session / "session.yaml");
  ASSERT_EQ(rig.find("extrinsics:"), std::string::npos);
  write_bytes(session / "session.yaml",
              rig +
                  "extrinsics:\n  - {parent: right, child: left, translation: [-0.14, 0, 0], "
                  "rotation: {x: 0, y: 0, z: 0, w: 1}, fixed: true}\n");
  EXPECT_NEAR(error(of_five(), "all at once"), 20, 2);
  // Without either, what all views say together.
  write_bytes(session / "session.yaml", rig);
  EXPECT_LT(error(of_five(), "all at once"), 2);
}

TEST_F(SmallSession, BenchStereoWantsTwoCameras) {
  const Outcome run = run_ca2({"bench", "stereo", "--data", session});
  EXPECT_EQ(run.status, 78);
  EXPECT_NE(run.errors.find("two cameras and a LiDAR"), std::string::npos) << run.errors;
}

}  // namespace
}  // namespace ca2
