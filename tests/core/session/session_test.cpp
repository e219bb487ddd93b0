#include "core/session/session.h"

#include <gtest/gtest.h>

#include "core/io/files.h"
#include "tests/core/session/rig_text.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

Rig test_rig() {
  return parse_rig(test::rig_text, "rig.yaml").value();
}

Image small_image() {
  return {2, 2, 1, 8, {1, 2, 3, 4}};
}

Scan small_scan() {
  Scan scan;
  scan.points = {{1, 2, 3}, {4, 5, 6}};
  scan.ring = {0, 1};
  scan.rings = 16;
  return scan;
}

bool warns(const Session& session, const std::string& part) {
  for (const Problem& problem : session.warnings) {
    if ((problem.where + ": " + problem.what).find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(Session, CreatedWrittenAndOpenedAgain) {
  const test::TemporaryDirectory directory;
  const fs::path path = directory / "a";
  const auto created = create_session(path, test_rig(), "2026-01-02T03:04:05Z");
  ASSERT_TRUE(created) << created.error().text();
  EXPECT_TRUE(created->views.empty());
  EXPECT_NE(read_text(path / "session.yaml").value().find("created: \"2026-01-02T03:04:05Z\""),
            std::string::npos);

  const std::string details = "stamps: {left: 1}\npicks:\n  top: {row: 3, column: 400, radius: 12.5}\n";
  const auto written = write_view(path, 1, {{"left", small_image()}}, {{"top", small_scan()}}, details);
  ASSERT_TRUE(written) << written.error().text();
  ASSERT_TRUE(write_view(path, 12, {{"left", small_image()}, {"right", small_image()}}, {}));

  const auto opened = open_session(path);
  ASSERT_TRUE(opened) << opened.error().text();
  EXPECT_EQ(write_rig(opened->rig), write_rig(test_rig()));
  ASSERT_EQ(opened->views.size(), 2u);
  EXPECT_EQ(opened->views[0].id, 1);
  EXPECT_EQ(opened->views[0].images, written->images);
  EXPECT_EQ(opened->views[0].clouds, written->clouds);
  EXPECT_EQ(opened->views[0].directory, path / "views" / "000001");
  EXPECT_EQ(opened->views[0].picks.at("top").column, 400);
  EXPECT_EQ(opened->views[0].picks.at("top").radius, 12.5);
  EXPECT_EQ(written->picks.at("top").row, 3);
  EXPECT_EQ(opened->views[1].images.size(), 2u);
  EXPECT_EQ(read_png(opened->views[0].images.at("left"))->bytes, small_image().bytes);
  EXPECT_EQ(read_pcd(opened->views[0].clouds.at("top"))->rings, 16);
  ASSERT_EQ(opened->warnings.size(), 1u);
  EXPECT_TRUE(warns(*opened, "000012: the view has no cloud of any lidar"));
}

TEST(Session, NothingIsOverwritten) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(create_session(directory.path(), test_rig()));
  const auto again = create_session(directory.path(), test_rig());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::cannot_create);

  ASSERT_TRUE(write_view(directory.path(), 1, {{"left", small_image()}}, {}));
  const auto twice = write_view(directory.path(), 1, {{"right", small_image()}}, {});
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().code, ErrorCode::cannot_create);
  // Not even an empty directory, which a plain rename would replace.
  fs::create_directory(directory / "views/000002");
  EXPECT_FALSE(write_view(directory.path(), 2, {{"left", small_image()}}, {}));
  const auto opened = open_session(directory.path()).value();
  ASSERT_EQ(opened.views.size(), 1u);
  EXPECT_EQ(opened.views[0].images.count("left"), 1u);
  // And nothing hidden stays behind.
  for (const auto& entry : fs::directory_iterator(directory / "views")) {
    EXPECT_NE(entry.path().filename().string().front(), '.');
  }
}

TEST(Session, AViewThatFailsHalfWayLeavesNothing) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(create_session(directory.path(), test_rig()));
  const Image broken{100, 100, 1, 8, {1}};
  const auto written = write_view(directory.path(), 1, {{"left", small_image()}, {"right", broken}}, {});
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().text().find("right.png"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(directory / "views"));
  EXPECT_FALSE(write_view(directory.path(), 1, {{"../left", small_image()}}, {}));
  EXPECT_FALSE(write_view(directory.path(), 1, {}, {}, "a: [1"));
  EXPECT_FALSE(write_view(directory / "none", 1, {{"left", small_image()}}, {}));
}

TEST(Session, WhatAPowerCutLeftIsIgnored) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(create_session(directory.path(), test_rig()));
  fs::create_directories(directory / "views/.000001.4711-0.tmp");
  ASSERT_TRUE(write_atomically(directory / "views/.000001.4711-0.tmp/left.png", "half a pict"));
  const auto opened = open_session(directory.path());
  ASSERT_TRUE(opened);
  EXPECT_TRUE(opened->views.empty());
  EXPECT_TRUE(opened->warnings.empty());
}

TEST(Session, OdditiesBecomeWarnings) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(create_session(directory.path(), test_rig()));
  const auto put = [&](const std::string& file, const std::string& content) {
    fs::create_directories((directory / ("views/" + file)).parent_path());
    ASSERT_TRUE(write_atomically(directory / ("views/" + file), content));
  };
  put("00001/left.png", "x");
  put("00001/top.pcd", "x");
  put("00001/lift.png", "x");
  put("00001/left.jpg", "x");
  put("00001/view.yaml", "picks: {top: {row: 1, column: [}");
  put("01/left.png", "x");
  put("2/top.pcd", "x");
  put("2/view.yaml", "picks: {top: {row: -1, column: 2}, tip: {row: 1, column: 1}}\nbest: 1\n");
  put("3/notes.txt", "x");
  put("first/left.png", "x");
  put("README", "x");
  put("99999999999999/left.png", "x");
  const auto opened = open_session(directory.path());
  ASSERT_TRUE(opened) << opened.error().text();
  ASSERT_EQ(opened->views.size(), 2u);
  EXPECT_EQ(opened->views[1].id, 2);
  EXPECT_TRUE(opened->views[1].picks.empty());
  for (const char* expected :
       {"lift.png: the rig has no camera 'lift'", "left.jpg: the file is not used", "view.yaml:1:",
        "there is a view 1 already", "views/2: the view has no picture", "'row' must be from 0",
        "there is no lidar 'tip'", "unknown key 'best'", "views/3: the view has neither",
        "first: is not a view", "README: is not a view", "99999999999999: is not a view"}) {
    EXPECT_TRUE(warns(*opened, expected)) << expected;
  }
}

TEST(Session, AMissingOrBrokenSessionIsAnError) {
  const test::TemporaryDirectory directory;
  EXPECT_EQ(open_session(directory / "none").error().code, ErrorCode::io);
  EXPECT_EQ(open_session(directory.path()).error().code, ErrorCode::io);
  ASSERT_TRUE(write_atomically(directory / "session.yaml", "version: 1\nbord: {}\n"));
  const auto broken = open_session(directory.path());
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, ErrorCode::config);
  EXPECT_NE(broken.error().text().find("session.yaml:2:1: unknown key 'bord'"), std::string::npos);
}

TEST(Session, ARigThatCouldNotBeReadAgainIsNotWritten) {
  const test::TemporaryDirectory directory;
  Rig rig = test_rig();
  rig.cameras["a/b"] = {};
  EXPECT_FALSE(create_session(directory / "s", rig));
  EXPECT_FALSE(fs::exists(directory / "s"));
}

TEST(Session, AViewIsTakenOutWhole) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(create_session(directory.path(), test_rig()));
  ASSERT_TRUE(write_view(directory.path(), 1, {{"left", small_image()}}, {{"top", small_scan()}}));
  const auto second = write_view(directory.path(), 2, {{"left", small_image()}}, {{"top", small_scan()}});
  ASSERT_TRUE(second);
  ASSERT_TRUE(remove_view(*second));
  EXPECT_EQ(open_session(directory.path())->views.size(), 1u);
  // Not even a hidden trace.
  EXPECT_EQ(std::distance(fs::directory_iterator(directory / "views"), fs::directory_iterator()), 1);
  EXPECT_EQ(remove_view(*second).error().code, ErrorCode::io);
}

}  // namespace
}  // namespace ca2
