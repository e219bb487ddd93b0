#include "tools/sim/session_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <ctime>

#include "core/io/files.h"
#include "core/io/yaml.h"
#include "core/session/session.h"
#include "tests/support/left_out.h"
#include "tests/tools/sim/test_rigs.h"
#include "tools/sim/feature_simulator.h"
#include "tools/sim/view_simulator.h"

namespace ca2 {
namespace {

class SimulatedSession : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "ca2_sim_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  /// Writes a scenario file from a shipped one with a line replaced.
  std::filesystem::path changed(const std::string& scenario, const std::string& from, const std::string& to) {
    std::string text = read_text(scenario_directory() / scenario).value();
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    const std::filesystem::path file = directory_ / scenario;
    EXPECT_TRUE(write_atomically(file, text));
    return file;
  }

  std::filesystem::path directory_;
};

TEST_F(SimulatedSession, EveryShippedScenarioHasPlacesForTheBoard) {
  int scenarios = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenario_directory())) {
    if (entry.path().extension() != ".yaml") continue;
    ++scenarios;
    if (test::left_out(entry.path().stem().string())) continue;
    const auto file = read_scenario(entry.path());
    ASSERT_TRUE(file) << file.error().text();
    Scenario scenario = file->scenario;
    scenario.views = 30;
    const auto start = std::chrono::steady_clock::now();
    const auto views = simulate_feature_views(scenario);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(views) << views.error().text();
    std::printf("%-24s simulate_features %6.2f ms per view\n", scenario.name.c_str(),
                elapsed.count() / scenario.views);
    for (const SimulatedView& view : *views) {
      EXPECT_EQ(view.corners.size(), scenario.cameras.size());
      for (const auto& [name, scan] : view.board_returns) {
        EXPECT_GE(static_cast<int>(scan.size()), scenario.placement.min_returns / 2);
      }
    }
  }
  EXPECT_GE(scenarios, 4);
}

TEST_F(SimulatedSession, EveryShippedRigIsRenderedInReasonableTime) {
  for (const char* name : {"paper", "os0_t265", "os0_manta", "vlp16_blackfly"}) {
    if (test::left_out(name)) continue;
    const auto file = read_scenario(scenario_directory() / (std::string(name) + ".yaml"));
    ASSERT_TRUE(file) << file.error().text();
    const ViewSimulator simulator(file->scenario);
    constexpr int views = 2;
    const std::clock_t start = std::clock();
    for (int id = 1; id <= views; ++id) {
      const auto view = simulator.render(id);
      ASSERT_TRUE(view) << view.error().text();
      EXPECT_EQ(view->images.size(), file->scenario.cameras.size());
      EXPECT_EQ(view->scans.size(), file->scenario.lidars.size());
    }
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / views;
    std::printf("%-16s %.0f ms of one core per view\n", name, 1e3 * seconds);
    EXPECT_LT(seconds, 10);
  }
}

TEST_F(SimulatedSession, IsASessionWithTheTruthBesideIt) {
  auto file = read_scenario(scenario_directory() / "vlp16_blackfly.yaml");
  ASSERT_TRUE(file) << file.error().text();
  file->scenario.views = 3;
  int calls = 0;
  const auto written = write_simulated_session(*file, directory_ / "a", [&](int done, int all) {
    EXPECT_EQ(done, ++calls);
    EXPECT_EQ(all, 3);
  });
  ASSERT_TRUE(written) << written.error().text();
  EXPECT_EQ(calls, 3);

  const auto session = open_session(directory_ / "a");
  ASSERT_TRUE(session) << session.error().text();
  ASSERT_EQ(session->views.size(), 3u);
  EXPECT_TRUE(session->warnings.empty());
  const Image image = read_png(session->views[0].images.at("front")).value();
  EXPECT_EQ(image.width, 1440);
  EXPECT_GT(read_pcd(session->views[0].clouds.at("puck")).value().size(), 20000u);

  // What the session is told about its camera is off, within what the scenario allows.
  const CameraParameters given = session->rig.cameras.at("front").intrinsics->parameters;
  const CameraParameters truth = file->scenario.cameras.at("front").camera.parameters;
  EXPECT_NE(given[0], truth[0]);
  EXPECT_LE(std::abs(given[0] / truth[0] - 1), 0.003 + 1e-12);
  EXPECT_LE((given - truth).segment<2>(2).lpNorm<Eigen::Infinity>(), 1.0 + 1e-12);

  const auto root = parse_yaml(read_text(directory_ / "a/truth.yaml").value(), "truth.yaml");
  ASSERT_TRUE(root) << root.error().text();
  EXPECT_EQ(root->find("transforms")->items.size(), 1u);
  EXPECT_EQ(root->find("views")->items.size(), 3u);
  const YamlNode& view = root->find("views")->items[2];
  EXPECT_EQ(view.find("id")->text, "3");
  EXPECT_EQ(view.find("board")->items.size(), 2u);
}

TEST_F(SimulatedSession, IsTheSameEveryTime) {
  auto file = read_scenario(scenario_directory() / "vlp16_blackfly.yaml");
  ASSERT_TRUE(file) << file.error().text();
  file->scenario.views = 2;
  ASSERT_TRUE(write_simulated_session(*file, directory_ / "a"));
  ASSERT_TRUE(write_simulated_session(*file, directory_ / "b"));
  for (const char* name : {"truth.yaml", "views/000001/front.png", "views/000002/puck.pcd"}) {
    EXPECT_EQ(read_text(directory_ / "a" / name).value(), read_text(directory_ / "b" / name).value()) << name;
  }
  const auto again = write_simulated_session(*file, directory_ / "a");
  EXPECT_FALSE(again) << "a session must not be written over";
}

TEST_F(SimulatedSession, HiddenIntrinsicsStayHidden) {
  const auto file = read_scenario(changed(
      "vlp16_blackfly.yaml", "intrinsics_error: {pixel: 1.0, focal: 0.003}", "hide_intrinsics: true"));
  ASSERT_TRUE(file) << file.error().text();
  EXPECT_FALSE(stated_rig(*file).cameras.at("front").intrinsics);
  EXPECT_TRUE(file->rig.cameras.at("front").intrinsics);
}

TEST_F(SimulatedSession, EveryMistakeInAScenarioHasItsPlace) {
  const struct {
    const char *from, *to, *expected;
  } cases[] = {
      {"  roll: 0.7", "  rol: 0.7", "roll"},
      {"distance: [1.5, 4.0]", "distance: [4.0, 1.5]", "[least, most]"},
      {"child: puck", "child: pucks", "puck"},
      {"model: VLP-16", "model: VLP-17", "VLP-16"},
      {"range_sigma: 0.010", "range_sigma: ten", "range_sigma"},
      {"  rig_height: 1.1", "  wrong_objects: {fraction: 0.3, kind: cat}", "panel"},
      {"  rig_height: 1.1", "  rig_height: 5", "ceiling"},
      {"noise:", "noises:", "noise"},
  };
  for (const auto& [from, to, expected] : cases) {
    const auto file = read_scenario(changed("vlp16_blackfly.yaml", from, to));
    ASSERT_FALSE(file) << to;
    EXPECT_EQ(file.error().code, ErrorCode::config) << to;
    EXPECT_NE(file.error().text().find(expected), std::string::npos) << file.error().text();
    EXPECT_NE(file.error().text().find("vlp16_blackfly.yaml"), std::string::npos) << file.error().text();
  }
  const auto missing = read_scenario(changed("vlp16_blackfly.yaml", "    - parent: front\n      child: puck",
                                             "    - parent: puck\n      child: puck"));
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().text().find("front"), std::string::npos) << missing.error().text();
}

}  // namespace
}  // namespace ca2
