/// @file A result that is not of what its session holds any more is told as such, and only that.
#include <nlohmann/json.hpp>

#include "core/session/calibration.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class OutdatedResult : public SmallSession {
 protected:
  void SetUp() override {
    SmallSession::SetUp();
    ASSERT_EQ(solve().status, 0);
  }

  std::string warnings(const fs::path& of) const {
    const Outcome outcome = run_ca2({"export", of, "--format", "ros"});
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_FALSE(outcome.output.empty());
    return outcome.errors;
  }
  std::string warnings() const { return warnings(session); }

  /// The one warning, which names the change and the command that cures it.
  void expect_warning(const std::string& change) const {
    EXPECT_EQ(warnings(), "ca2: " + result().string() +
                              ": warning: the session is not what this result was made of any more: " +
                              change + "; run `ca2 solve " + session.string() + "`\n");
  }

  void add_view(int id) const {
    fs::copy(session / "views/000001", session / "views" / ("00000" + std::to_string(id)));
  }
};

TEST_F(OutdatedResult, ViewsThatCameWentOrChangedAreNamed) {
  EXPECT_EQ(warnings(), "");
  add_view(9);
  expect_warning("view 9 is new");
  fs::remove_all(session / "views/000009");
  EXPECT_EQ(warnings(), "");
  fs::remove_all(session / "views/000002");
  fs::copy_file(picture(4), picture(7), fs::copy_options::overwrite_existing);
  fs::remove(cloud(5));
  fs::remove(cloud(6));
  expect_warning("views 5-7 are changed, view 2 is gone");
  ASSERT_EQ(solve().status, 0);
  EXPECT_EQ(warnings(), "");
}

TEST_F(OutdatedResult, APickIsPartOfItsView) {
  write_bytes(view_file(3, "view.yaml"), "trigger: manual\n");
  EXPECT_EQ(warnings(), "");
  write_bytes(view_file(3, "view.yaml"), "picks: {puck: {row: 8, column: 900}}\n");
  expect_warning("view 3 is changed");
}

TEST_F(OutdatedResult, PartsOfTheRigAreNamed) {
  edit_rig("rows: 5", "rows: 4");
  expect_warning("the board is another");
  edit_rig("rows: 4", "rows: 5");
  edit_rig("517.5", "517.25");
  expect_warning("camera 'front' is another");
  edit_rig("517.25", "517.5");
  edit_rig("VLP-16", "HDL-32E");
  expect_warning("lidar 'puck' is another");
  write_bytes(session / "session.yaml",
              bytes_of(session / "session.yaml") +
                  "extrinsics:\n- {parent: front, child: puck, translation: [0, 0, 0],"
                  " rotation: {x: 0.7, y: 0, z: 0, w: 0.714}}\n");
  expect_warning("what is known of the extrinsics is another, lidar 'puck' is another");
}

TEST_F(OutdatedResult, CopiesTimesCommentsAndWaysToSensorsAreNoChange) {
  fs::copy(session, folder / "copy", fs::copy_options::recursive);
  EXPECT_EQ(warnings(folder / "copy"), "");
  fs::remove_all(folder / "copy/cache");
  for (const auto& file : fs::recursive_directory_iterator(folder / "copy"))
    fs::last_write_time(file.path(), fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_EQ(warnings(folder / "copy"), "");
  edit_rig("cameras:", "# Of the second day.\ncameras:");
  edit_rig("    model: VLP-16\n", "    model: VLP-16\n    source: {host: 192.0.2.7}\n");
  EXPECT_EQ(warnings(), "");
}

TEST_F(OutdatedResult, ViewsThatWereNotAskedForAreNotMissed) {
  ASSERT_EQ(solve({"--views", "1-6"}).status, 0);
  EXPECT_EQ(warnings(), "");
  fs::remove_all(session / "views/000007");
  EXPECT_EQ(warnings(), "");
  add_view(9);
  expect_warning("view 9 is new");
}

TEST_F(OutdatedResult, AViewThatWasNotUsedIsNotMissed) {
  fs::copy_file(cloud(1), cloud(4), fs::copy_options::overwrite_existing);
  ASSERT_EQ(solve().status, 0);
  const auto answer = read_calibration(result());
  ASSERT_TRUE(answer);
  ASSERT_FALSE(answer->views[3].used);
  fs::remove_all(session / "views/000004");
  EXPECT_EQ(warnings(), "");
}

TEST_F(OutdatedResult, ReportAndCheckSayItToo) {
  add_view(9);
  const std::string what = "the session is not what this result was made of any more: view 9 is new";
  const Outcome report = run_ca2({"report", session});
  EXPECT_EQ(report.status, 0) << report.errors;
  EXPECT_NE(report.errors.find("warning: " + what), std::string::npos) << report.errors;
  const std::string page = bytes_of(session / "report/index.html");
  EXPECT_NE(page.find(what), std::string::npos);
  EXPECT_LT(page.find(what), page.find("Verdict:")) << "before what it is about";
  const Outcome check = run_ca2({"check", session, "--json"});
  EXPECT_EQ(check.status, 0) << check.errors;
  EXPECT_EQ(nlohmann::json::parse(check.output).at(0).at("warnings").at(0).at("what"), what);
}

/// Results of earlier versions, and of others.
TEST_F(OutdatedResult, AResultThatDoesNotSayWhatItIsOfIsBelieved) {
  const std::string text = bytes_of(result());
  write_bytes(result(), text.substr(0, text.find("inputs:")));
  add_view(9);
  EXPECT_EQ(warnings(), "");
}

}  // namespace
}  // namespace ca2
