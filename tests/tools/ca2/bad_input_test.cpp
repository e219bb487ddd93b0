/// @file Damaged sessions: the file and the place are named, and the views that are fine are used.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "core/session/calibration.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

std::string ascii_cloud(int promised, const std::string& points) {
  const std::string count = std::to_string(promised);
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
         "\nHEIGHT 1\nPOINTS " + count + "\nDATA ascii\n" + points;
}

/// solve only warns of what check calls a problem; the place and the words are the same.
std::string plain(std::string text) {
  const std::string word = "warning: ";
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word)) text.erase(at, word.size());
  return text;
}

class BadInput : public SmallSession {
 protected:
  /// solve does without the views in `bad`, whose reasons and whose line on stderr say why; check says the
  /// same and ends with `check_status`.
  void expect_left_out(const std::map<int, std::string>& bad, const std::vector<std::string>& lines,
                       int check_status) const {
    const Outcome run = solve();
    ASSERT_EQ(run.status, 0) << run.errors;
    const auto answer = read_calibration(result());
    ASSERT_TRUE(answer) << answer.error().text();
    EXPECT_EQ(answer->views.size(), static_cast<std::size_t>(view_count));
    EXPECT_NE(answer->observability.verdict, "refused");
    for (const CalibratedView& view : answer->views) {
      const auto expected = bad.find(view.id);
      EXPECT_EQ(view.used, expected == bad.end()) << "view " << view.id << ": " << view.reason;
      if (expected == bad.end()) continue;
      EXPECT_NE(view.reason.find(expected->second), std::string::npos) << view.reason;
    }
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), static_cast<long>(lines.size()))
        << run.errors;
    fs::remove(result());
    const Outcome check = run_ca2({"check", session, "--json"});
    EXPECT_EQ(check.status, check_status) << check.errors;
    const auto findings = nlohmann::json::parse(check.output);
    EXPECT_EQ(findings.at(0).at("ok"), check_status == 0);
    EXPECT_EQ(std::count(check.errors.begin(), check.errors.end(), '\n'), static_cast<long>(lines.size()))
        << check.errors;
    for (const std::string& line : lines) {
      EXPECT_NE(plain(run.errors).find(session.string() + "/" + line), std::string::npos) << line << "\n"
                                                                                          << run.errors;
      EXPECT_NE(plain(check.errors).find(session.string() + "/" + line), std::string::npos) << line << "\n"
                                                                                            << check.errors;
    }
  }

  void truncate(const fs::path& file, std::size_t size) const {
    const std::string text = bytes_of(file);
    ASSERT_GT(text.size(), size);
    write_bytes(file, text.substr(0, size));
  }
};

TEST_F(BadInput, CutShort) {
  truncate(picture(2), 3000);
  truncate(cloud(4), 3000);
  write_bytes(cloud(6), ascii_cloud(3, "1 2 3\n1 2 4\n"));
  expect_left_out({{2, "front.png: is a damaged PNG picture"},
                   {4, "puck.pcd: is cut short"},
                   {6, "puck.pcd: is cut short: the header promises 3 points, 2 are there"}},
                  {"views/000002/front.png: ", "views/000004/puck.pcd: ", "views/000006/puck.pcd:12: "}, 65);
}

TEST_F(BadInput, CloudsWithoutReturns) {
  write_bytes(cloud(1), ascii_cloud(0, ""));
  write_bytes(cloud(3), ascii_cloud(3, "nan nan nan\nnan nan nan\nnan nan nan\n"));
  write_bytes(cloud(5), "");
  expect_left_out(
      {{1, "the cloud has no points"}, {3, "none of the cloud's 3 points"}, {5, "is empty"}},
      {"views/000001/puck.pcd: the cloud has no points",
       "views/000003/puck.pcd: none of the cloud's 3 points is a return", "views/000005/puck.pcd: is empty"},
      65);
}

TEST_F(BadInput, PicturesOfAnotherSize) {
  ASSERT_TRUE(write_png(picture(1), {320, 240, 1, 8, std::vector<std::uint8_t>(320 * 240, 90)}));
  expect_left_out({{1, "the picture is 320 x 240"}}, {"views/000001/front.png: the picture is 320 x 240"},
                  65);
}

TEST_F(BadInput, WithoutImageSizeMostPicturesDecide) {
  edit_rig("    image_size: [640, 480]\n", "");
  ASSERT_TRUE(write_png(picture(1), {320, 240, 1, 8, std::vector<std::uint8_t>(320 * 240, 90)}));
  const Outcome run = solve();
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_NE(run.output.find("7 of 8 used"), std::string::npos) << run.output;
  EXPECT_NE(run.errors.find("views/000001/front.png: warning: the picture is 320 x 240"), std::string::npos)
      << run.errors;
  EXPECT_NE(bytes_of(result()).find("image_size: [640, 480]"), std::string::npos);
}

TEST_F(BadInput, AllPicturesOfAnotherSizeIsBadData) {
  edit_rig("image_size: [640, 480]", "image_size: [640, 481]");
  const Outcome run = solve();
  EXPECT_EQ(run.status, 65);
  for (int view = 1; view <= view_count; ++view) {
    EXPECT_NE(run.errors.find(picture(view).string() + ": the picture is 640 x 480"), std::string::npos);
  }
  EXPECT_NE(run.errors.find("front: none of its 8 pictures can be used"), std::string::npos) << run.errors;
  EXPECT_FALSE(fs::exists(result()));
}

TEST_F(BadInput, ADirectoryInPlaceOfAFile) {
  fs::remove(cloud(3));
  fs::create_directory(cloud(3));
  fs::remove(picture(5));
  fs::create_directory(picture(5));
  expect_left_out({{3, "puck.pcd: is a directory"}, {5, "front.png: is a directory"}},
                  {"views/000003/puck.pcd: ", "views/000005/front.png: "}, 74);
}

TEST_F(BadInput, MissingFilesAreWarnings) {
  fs::remove(cloud(3));
  fs::remove(picture(5));
  expect_left_out({{3, "there is no cloud of puck"}, {5, "there is no picture of front"}},
                  {"views/000003: the view has no cloud", "views/000005: the view has no picture"}, 0);
}

TEST_F(BadInput, WhereTheBoardIsNot) {
  ASSERT_TRUE(write_png(picture(2), {640, 480, 1, 8, std::vector<std::uint8_t>(640 * 480, 90)}));
  write_bytes(cloud(7), ascii_cloud(3, "1 2 3\n2 2 3\n3 2 2\n"));
  expect_left_out({{2, "no camera found the board"}, {7, "no LiDAR found anything"}}, {}, 0);
}

TEST_F(BadInput, GapsAndExtraFilesDoNotDisturb) {
  fs::remove_all(picture(2).parent_path());
  fs::rename(picture(8).parent_path(), session / "views" / "000120");
  write_bytes(view_file(1, "notes.txt"), "windy");
  write_bytes(view_file(1, "rear.png"), "not of this rig");
  fs::create_directory(session / "views" / ".000009.new");
  const Outcome run = solve({"--views", "1,3-7,120"});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_NE(run.output.find("7 of 7 used"), std::string::npos) << run.output;
  EXPECT_NE(run.errors.find("views/000001/notes.txt: warning: the file is not used"), std::string::npos)
      << run.errors;
  EXPECT_NE(run.errors.find("the rig has no camera 'rear'"), std::string::npos) << run.errors;
  const auto answer = read_calibration(result());
  ASSERT_TRUE(answer) << answer.error().text();
  EXPECT_EQ(answer->views.back().id, 120);
  EXPECT_EQ(run_ca2({"report", session}).status, 0);
}

TEST_F(BadInput, HostileYaml) {
  const std::string good = bytes_of(session / "session.yaml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  std::string bomb = "a: &a [x, x, x, x, x, x, x, x]\n";
  for (char level = 'b'; level < 'k'; ++level) {
    const std::string below = std::string("*") + static_cast<char>(level - 1);
    bomb += std::string(1, level) + ": &" + level + " [" + below + ", " + below + ", " + below + "]\n";
  }
  const std::vector<std::pair<std::string, std::string>> cases{
      {bomb, "session.yaml:1:4: anchors and aliases are not allowed"},
      {"version: 1\nboard: " + std::string(100000, '[') + std::string(100000, ']'), "nest deeper than 32"},
      {"version: 1\nboard: " + std::string(100000, '['), "session.yaml:2:"},
      {with("columns: 8", "columns: 99999999999999999999999999"), "session.yaml:4:12: 'columns' must be"},
      {with("columns: 8", "columns: 1e999"), "session.yaml:4:12: "},
      {with("[640, 480]", "[1e9, -1]"), "session.yaml:11:"},
      {good + std::string(10'000'000, ' '), "session.yaml: is larger than"},
      {std::string(10'000, '\0'), "session.yaml: "},
      {"", "session.yaml: is empty"},
  };
  for (const auto& [text, words] : cases) {
    write_bytes(session / "session.yaml", text);
    for (const char* command : {"solve", "check"}) {
      const Outcome run = run_ca2({command, session});
      EXPECT_EQ(run.status, 78) << command << " " << run.errors;
      EXPECT_NE(run.errors.find(words), std::string::npos) << command << ": " << words << "\n" << run.errors;
    }
    EXPECT_FALSE(fs::exists(result()));
  }
}

}  // namespace
}  // namespace ca2
