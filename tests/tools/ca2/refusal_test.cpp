/// @file What solve and report do not do, and the exit status that says so.
#include "core/io/files.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class Refusal : public SmallSession {
 protected:
  /// The run failed as it should: its status, its words on stderr, nothing on stdout, no result.
  void expect_failure(const Outcome& run, int status, const std::string& words) const {
    EXPECT_EQ(run.status, status) << run.errors;
    EXPECT_NE(run.errors.find(words), std::string::npos) << run.errors;
    EXPECT_EQ(run.errors.rfind("ca2: ", 0), 0u) << run.errors;
    EXPECT_EQ(run.output, "");
    EXPECT_FALSE(fs::exists(result()));
  }

  /// A picture of the right size without a board.
  void blank_picture(int view, const std::string& name = "front.png") const {
    ASSERT_TRUE(write_png(view_file(view, name), {640, 480, 1, 8, std::vector<std::uint8_t>(640 * 480, 90)}));
  }
};

TEST_F(Refusal, Usage) {
  expect_failure(solve({"--bogus"}), 64, "--bogus");
  expect_failure(solve({"--views", "1,x"}), 64, "cannot read 'x'");
  expect_failure(solve({"--views", "3-1"}), 64, "cannot read '3-1'");
  expect_failure(solve({"--views", ","}), 64, "--views");
  expect_failure(solve({"--views", "1-99999999999"}), 64, "--views");
  expect_failure(solve({"--views", "7-9"}), 64, "there is no view 9; the session has 8 views, from 1 to 8");
  expect_failure(solve({"--method", "guess"}), 64, "guess");
  expect_failure(solve({"--threads", "0"}), 64, "--threads");
  expect_failure(run_ca2({}), 64, "see `ca2 --help`");
  expect_failure(run_ca2({"slove", session}), 64, "no command 'slove'; did you mean 'solve'?");
  expect_failure(run_ca2({"report"}), 64, "session");
}

TEST_F(Refusal, NoSessionAndNoPlaceForTheResult) {
  expect_failure(run_ca2({"solve", folder / "nowhere"}), 74, (folder / "nowhere").string());
  expect_failure(run_ca2({"solve", folder.path()}), 74, "has no session.yaml");
  expect_failure(run_ca2({"report", folder / "nowhere"}), 74, "nowhere");
  expect_failure(run_ca2({"solve"}), 69, "ca2 solve SESSION");
  const Outcome under_a_file = solve({"--output", session / "session.yaml" / "result.yaml"});
  EXPECT_EQ(under_a_file.status, 73) << under_a_file.errors;
  EXPECT_NE(under_a_file.errors.find("session.yaml/result.yaml"), std::string::npos) << under_a_file.errors;
  fs::remove_all(session / "views");
  expect_failure(solve(), 65, "the session has no views");
}

TEST_F(Refusal, ACacheThatCannotBeWrittenDoesNotMatter) {
  fs::remove_all(session / "cache");
  write_bytes(session / "cache", "a file where the directory should be");
  const Outcome run = solve();
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_TRUE(fs::exists(result()));
}

TEST_F(Refusal, TwoViewsWithoutAnOutlineAreNotEnoughAndAnEarlierResultIsSetAside) {
  edit_rig("  outline: {width: 0.84099999999999997, height: 0.59399999999999997, center: [0, 0]}\n", "");
  ASSERT_EQ(solve().status, 0);
  const std::string earlier = bytes_of(result());
  const Outcome run = solve({"--views", "1,2"});
  EXPECT_EQ(run.status, 1);
  EXPECT_FALSE(fs::exists(result()));
  EXPECT_EQ(bytes_of(session / "result.previous.yaml"), earlier);
  EXPECT_NE(run.errors.find("views"), std::string::npos) << run.errors;
  EXPECT_EQ(solve({"--views", "1,2", "--method", "kim"}).status, 1);
  EXPECT_EQ(solve({"--views", "1,2", "--method", "plane_to_plane"}).status, 1);
  EXPECT_FALSE(fs::exists(result()));
}

TEST_F(Refusal, ParallelBoardsAreRefusedInWords) {
  for (int view = 2; view <= view_count; ++view) {
    fs::copy_file(picture(1), picture(view), fs::copy_options::overwrite_existing);
    fs::copy_file(cloud(1), cloud(view), fs::copy_options::overwrite_existing);
  }
  for (const char* method : {"joint", "kim", "plane_to_plane"}) {
    const Outcome run = solve({"--method", method});
    expect_failure(run, 1, "tilt");
  }
}

TEST_F(Refusal, ABrokenRigIsAConfigurationError) {
  edit_rig("image_size", "image_sise");
  expect_failure(solve(), 78,
                 "session.yaml:11:5: unknown key 'image_sise' in a camera; did you mean 'image_size'?");
  edit_rig("columns: 8", "columns: -8");
  const Outcome both = solve();
  expect_failure(both, 78, "image_sise");
  expect_failure(both, 78, "'columns' must be");
}

TEST_F(Refusal, ARigWithoutLidarOrCameraIsNotSolved) {
  const std::string whole = bytes_of(session / "session.yaml");
  edit_rig("lidars:\n  puck:\n    frame: velodyne\n    model: VLP-16\n", "");
  expect_failure(solve(), 78, "the rig has no lidar");
  const std::size_t from = whole.find("cameras:");
  write_bytes(session / "session.yaml", whole.substr(0, from) + whole.substr(whole.find("lidars:")));
  expect_failure(solve(), 78, "the rig has no camera");
}

TEST_F(Refusal, ASensorThatNeverSawTheBoardIsNamed) {
  for (int view = 1; view <= view_count; ++view) {
    write_bytes(cloud(view),
                "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\n"
                "HEIGHT 1\nPOINTS 3\nDATA ascii\n1 2 3\n2 2 3\n3 2 2\n");
  }
  expect_failure(solve(), 1, "puck: the board was found in none of its 8 clouds");
}

TEST_F(Refusal, OneOfTwoCamerasThatNeverSawTheBoardIsNamed) {
  edit_rig("lidars:",
           "  right:\n    image_size: [640, 480]\n"
           "    intrinsics: {model: pinhole_radtan, parameters: [518, 518, 320, 240, 0, 0, 0, 0]}\nlidars:");
  expect_failure(solve(), 1, "right: there are no pictures of this sensor in the views");
  for (int view = 1; view <= view_count; ++view) blank_picture(view, "right.png");
  expect_failure(solve(), 1, "right: the board was found in none of its 8 pictures");
  edit_rig("    intrinsics: {model: pinhole_radtan, parameters: [518, 518, 320, 240, 0, 0, 0, 0]}\n", "");
  expect_failure(solve(), 1, "right: the board was found in none of its 8 pictures");
}

TEST_F(Refusal, SquaresCountedForInnerCornersAreToldFromWhatThePicturesShow) {
  edit_rig("columns: 8", "columns: 9");
  edit_rig("rows: 5", "rows: 6");
  expect_failure(solve(), 1,
                 "front: the board was found in none of its 8 pictures; one of 8 x 5 inner corners is in ");
  expect_failure(solve(), 1,
                 "/000001/front.png, the rig says 9 x 6: columns and rows count inner corners, not squares");
  edit_rig("rows: 6", "rows: 3");
  expect_failure(solve(), 1,
                 "pictures; is it the board of the rig (type, columns, rows), and whole in the picture?");
}

/// Whatever state a session is in, the report says what is missing.
TEST_F(Refusal, ReportsOfUnfinishedAndBrokenSessions) {
  const auto page = [&] { return bytes_of(session / "report" / "index.html"); };
  const Outcome unsolved = run_ca2({"report", session});
  EXPECT_EQ(unsolved.status, 0) << unsolved.errors;
  EXPECT_NE(unsolved.errors.find("run `ca2 solve"), std::string::npos) << unsolved.errors;
  EXPECT_NE(page().find("Not calibrated"), std::string::npos);
  EXPECT_NE(page().find("run `ca2 solve"), std::string::npos);
  for (const std::string& garbage : {std::string("version: 1\nmethod: [\n"), std::string(5000, '\0'),
                                     std::string("no result at all\n"), std::string()}) {
    write_bytes(result(), garbage);
    const Outcome run = run_ca2({"report", session});
    EXPECT_EQ(run.status, 65) << run.errors;
    EXPECT_NE(run.errors.find("result.yaml"), std::string::npos) << run.errors;
    EXPECT_NE(page().find("result.yaml"), std::string::npos);
  }
  fs::remove(result());
  edit_rig("  outline: {width: 0.84099999999999997, height: 0.59399999999999997, center: [0, 0]}\n", "");
  for (int view = 3; view <= view_count; ++view) fs::remove_all(view_file(view, "").parent_path());
  EXPECT_EQ(run_ca2({"report", session}).status, 0);
  EXPECT_NE(page().find("views"), std::string::npos);
  EXPECT_EQ(page().find("run `ca2 solve"), std::string::npos) << "two views of planes determine nothing";
  fs::remove_all(session / "views");
  EXPECT_EQ(run_ca2({"report", session}).status, 0);
  EXPECT_NE(page().find("There are no views yet"), std::string::npos);
  edit_rig("columns: 8", "columns: eight");
  const Outcome broken = run_ca2({"report", session});
  EXPECT_EQ(broken.status, 78) << broken.errors;
  EXPECT_NE(page().find("session.yaml"), std::string::npos);
}

TEST_F(Refusal, ReportOfASolvedSessionWhoseFilesAreGone) {
  ASSERT_EQ(solve().status, 0);
  fs::remove(picture(1));
  fs::remove(cloud(2));
  write_bytes(picture(3), "no picture");
  const Outcome run = run_ca2({"report", session});
  EXPECT_EQ(run.status, 0) << run.errors;
  const std::string page = bytes_of(session / "report" / "index.html");
  EXPECT_NE(page.find("Verdict: good"), std::string::npos);
  EXPECT_NE(page.find("000003/front.png"), std::string::npos);
  fs::remove_all(session / "report");
  write_bytes(session / "report", "a file where the directory should be");
  EXPECT_EQ(run_ca2({"report", session}).status, 73);
}

}  // namespace
}  // namespace ca2
