/// The table of drivers, what a rig's sources become, and the sources that need no device.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <thread>

#include "core/board/board.h"
#include "core/io/files.h"
#include "core/io/jpeg.h"
#include "drivers/camera/camera_driver.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

using std::chrono::milliseconds;

std::string error_of(const SourceOptions& source) {
  const auto opened = open_camera(source);
  return opened ? "" : opened.error().text();
}

TEST(CameraDrivers, NamesAndOptionsAreUniqueAndExplained) {
  std::set<std::string_view> names;
  for (const CameraDriver* driver : camera_drivers()) {
    EXPECT_TRUE(names.insert(driver->name).second);
    EXPECT_FALSE(driver->what.empty());
    std::set<std::string_view> options{"driver"};
    bool identifies = false;
    for (const CameraOption& option : driver->options) {
      EXPECT_TRUE(options.insert(option.name).second) << driver->name << " " << option.name;
      EXPECT_FALSE(option.what.empty()) << driver->name << " " << option.name;
      identifies = identifies || option.identifies;
    }
    EXPECT_TRUE(identifies) << driver->name << ": two of its cameras could not be told apart";
  }
}

TEST(CameraDrivers, UnknownOptionsOfEveryDriverAreNamedWithTheKnown) {
  for (const CameraDriver* driver : camera_drivers()) {
    const std::string error =
        error_of({{"driver", std::string(driver->name)}, {"zzz_not_an_option_of_anything", "1"}});
    EXPECT_NE(error.find("unknown key 'zzz_not_an_option_of_anything'"), std::string::npos) << error;
    for (const CameraOption& option : driver->options) {
      EXPECT_NE(error.find(option.name), std::string::npos) << error;
    }
  }
}

TEST(CameraDrivers, WrongDriversAreNamedWithTheKnown) {
  EXPECT_NE(error_of({}).find("has no 'driver'; known are: "), std::string::npos);
  EXPECT_NE(error_of({{"driver", "patern"}}).find("did you mean 'pattern'?"), std::string::npos);
}

TEST(CameraDrivers, OnesThatWereLeftOutNameTheOption) {
  for (const CameraDriver* driver : camera_drivers()) {
    if (driver->name == "aravis") GTEST_SKIP() << "this build has all of them";
  }
  EXPECT_NE(error_of({{"driver", "aravis"}}).find("-DCA2_WITH_ARAVIS=ON"), std::string::npos);
  const CameraListing listing = list_cameras();
  ASSERT_FALSE(listing.problems.empty());
  EXPECT_EQ(listing.problems.back().where, "aravis");
}

TEST(CameraDrivers, AllProblemsOfASourceAreReported) {
  const std::string error =
      error_of({{"driver", "pattern"}, {"width", "12x"}, {"frame_rate", "-1"}, {"format", "Mono9"}});
  EXPECT_NE(error.find("'width' must be a whole number, not '12x'"), std::string::npos) << error;
  EXPECT_NE(error.find("'frame_rate' must be from 0.1 to 1000"), std::string::npos) << error;
  EXPECT_NE(error.find("'format' cannot be 'Mono9'; did you mean 'Mono8'?"), std::string::npos) << error;
}

RigCamera camera(SourceOptions source) {
  RigCamera camera;
  camera.source = std::move(source);
  return camera;
}

TEST(CameraDevices, SourcesOfOneDeviceAreOpenedOnce) {
  const auto devices = camera_devices(
      {{"a", camera({{"driver", "pattern"}, {"id", "x"}, {"imager", "left"}, {"width", "320"}})},
       {"b", camera({{"driver", "pattern"}, {"id", "x"}, {"imager", "right"}})},
       {"c", camera({{"driver", "pattern"}, {"id", "y"}})}});
  ASSERT_TRUE(devices) << devices.error().text();
  ASSERT_EQ(devices->size(), 2u);
  EXPECT_EQ((*devices)[0].cameras, (std::map<std::string, std::string>{{"left", "a"}, {"right", "b"}}));
  EXPECT_EQ((*devices)[0].source, (SourceOptions{{"driver", "pattern"}, {"id", "x"}, {"width", "320"}}));
  EXPECT_EQ((*devices)[1].cameras, (std::map<std::string, std::string>{{"", "c"}}));
}

TEST(CameraDevices, WhatDoesNotFitTogetherIsReportedWhole) {
  const auto devices = camera_devices({{"a", camera({{"driver", "pattern"}, {"id", "x"}, {"width", "320"}})},
                                       {"b", camera({{"driver", "pattern"}, {"id", "x"}, {"width", "640"}})},
                                       {"c", camera({})}});
  ASSERT_FALSE(devices);
  const std::string text = devices.error().text();
  EXPECT_NE(text.find("camera b: 'width' is '640', and '320'"), std::string::npos) << text;
  EXPECT_NE(text.find("camera b: camera a has the same source"), std::string::npos) << text;
  EXPECT_NE(text.find("camera c: source: has no 'driver'"), std::string::npos) << text;
}

TEST(CameraDevices, ImagersAreFoundByName) {
  const auto source = open_camera({{"driver", "pattern"}});
  ASSERT_TRUE(source);
  EXPECT_EQ(find_stream(**source, "").value(), 0);
  const auto wrong = find_stream(**source, "left");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("leave 'imager' out"), std::string::npos);
}

CameraFrame next_frame(CameraSource& source) {
  for (int i = 0; i < 100; ++i) {
    CameraPoll poll = source.next(milliseconds(100));
    if (poll.event == CameraEvent::frame) return poll.frame;
    EXPECT_EQ(poll.event, CameraEvent::timeout);
  }
  ADD_FAILURE() << "no picture in 10 s";
  return {};
}

/// What the virtual camera shows is what its stream says it is: the board is found where a board of that size
/// must be, and it is still while held.
TEST(Pattern, ShowsABoardThatIsHeldAndMoved) {
  const auto source =
      open_camera({{"driver", "pattern"}, {"frame_rate", "100"}, {"hold", "0.2"}, {"move", "0.3"}});
  ASSERT_TRUE(source) << source.error().text();
  const Board board{find_board_type("checkerboard"), 8, 6, 0.04, 0, 0, {}, {}};
  const Camera camera = *(*source)->streams()[0].intrinsics;
  ASSERT_TRUE((*source)->start());
  std::vector<Eigen::Vector2d> held, moved;
  std::int64_t last = 0;
  for (const double until : {0.1, 0.35}) {
    CameraFrame frame;
    const auto begin = std::chrono::steady_clock::now();
    std::int64_t first = 0;
    do {
      frame = next_frame(**source);
      ASSERT_TRUE(frame.image);
      EXPECT_GT(frame.time, last);
      last = frame.time;
      if (first == 0) first = frame.time;
    } while (std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(until));
    const auto corners = detect_board(board, *frame.image);
    ASSERT_EQ(corners.size(), 48u);
    const auto pose = estimate_board_pose(board, camera, corners);
    ASSERT_TRUE(pose);
    EXPECT_LT(pose->reprojection_rms, 0.1);
    for (const Corner& corner : corners) (held.size() < 48 ? held : moved).push_back(corner.pixel);
  }
  double shift = 0;
  for (std::size_t i = 0; i < 48; ++i) shift = std::max(shift, (held[i] - moved[i]).norm());
  EXPECT_GT(shift, 3);
}

TEST(Pattern, ShowsEveryTypeOfBoard) {
  for (const BoardType* type : board_types()) {
    const auto source = open_camera({{"driver", "pattern"}, {"board", std::string(type->name())}});
    ASSERT_TRUE(source) << type->name() << ": " << source.error().text();
    ASSERT_TRUE((*source)->start());
    const CameraFrame frame = next_frame(**source);
    std::size_t dark = 0;
    for (const std::uint8_t grey : frame.image->bytes) dark += grey < 60;
    EXPECT_GT(dark, frame.image->bytes.size() / 200) << type->name();
  }
}

TEST(Pattern, RampIsPixelExactInEveryFormat) {
  for (const std::string format : {"Mono8", "Mono16", "RGB8"}) {
    const auto source = open_camera({{"driver", "pattern"},
                                     {"pattern", "ramp"},
                                     {"format", format},
                                     {"frame_rate", "200"},
                                     {"width", "301"},
                                     {"height", "40"}});
    ASSERT_TRUE(source) << source.error().text();
    ASSERT_TRUE((*source)->start());
    next_frame(**source);
    const CameraFrame frame = next_frame(**source);
    const Image grey = to_grey8(*frame.image);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 301; ++x) {
        ASSERT_EQ(grey.bytes[static_cast<std::size_t>(301 * y + x)],
                  (x + y + static_cast<int>(frame.sequence)) & 0xff);
      }
    }
  }
}

TEST(Pattern, LateReadersGetTheNewestAndAreTold) {
  const auto source = open_camera({{"driver", "pattern"}, {"pattern", "ramp"}, {"frame_rate", "100"}});
  ASSERT_TRUE((*source)->start());
  const CameraFrame first = next_frame(**source);
  std::this_thread::sleep_for(milliseconds(200));
  const CameraFrame late = next_frame(**source);
  EXPECT_GE(late.sequence - first.sequence, 19u);
  EXPECT_EQ((*source)->counters().overrun, late.sequence - first.sequence - 1);
}

TEST(Pattern, ControlsAndTrigger) {
  const auto source = open_camera({{"driver", "pattern"}, {"pattern", "ramp"}, {"frame_rate", "50"}});
  ASSERT_TRUE((*source)->start());
  EXPECT_FALSE((*source)->trigger());
  EXPECT_FALSE((*source)->set_control("frame_rate", "0"));
  EXPECT_FALSE((*source)->set_control("shutter", "1"));
  ASSERT_TRUE((*source)->set_control("trigger", "software"));
  EXPECT_EQ((*source)->controls()["trigger"].value, "software");
  EXPECT_EQ((*source)->next(milliseconds(100)).event, CameraEvent::timeout);
  ASSERT_TRUE((*source)->trigger());
  EXPECT_EQ((*source)->next(milliseconds(1000)).event, CameraEvent::frame);
  EXPECT_EQ((*source)->next(milliseconds(50)).event, CameraEvent::timeout);
}

TEST(Pattern, InterruptWakesTheReader) {
  const auto source = open_camera({{"driver", "pattern"}, {"frame_rate", "0.1"}});
  ASSERT_TRUE((*source)->start());
  next_frame(**source);
  std::thread other([&] {
    std::this_thread::sleep_for(milliseconds(50));
    (*source)->interrupt();
  });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ((*source)->next(milliseconds(8000)).event, CameraEvent::stopped);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds(4000));
  EXPECT_EQ((*source)->next(milliseconds(0)).event, CameraEvent::stopped);
  other.join();
}

Image small_picture(int bits, int level) {
  Image image{4, 3, 1, bits, {}};
  image.bytes.assign(12 * image.bytes_per_pixel(), static_cast<std::uint8_t>(level));
  return image;
}

TEST(ImageFolder, GivesPicturesInTheOrderOfTheirTimes) {
  const test::TemporaryDirectory directory;
  const auto folder = directory.path();
  ASSERT_TRUE(write_png(folder / "2000000000.png", small_picture(16, 3)));
  ASSERT_TRUE(write_png(folder / "999999999.png", small_picture(8, 1)));
  std::ofstream(folder / "1500000000.jpg", std::ios::binary) << encode_jpeg(small_picture(8, 2), 100).value();
  std::ofstream(folder / "1600000000.png") << "torn";
  std::ofstream(folder / ".1700000000.png") << "being written";
  const auto source = open_camera({{"driver", "image_folder"}, {"path", folder.string()}, {"speed", "0"}});
  ASSERT_TRUE(source) << source.error().text();
  EXPECT_EQ((*source)->streams()[0].width, 4);
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE((*source)->start());
    std::vector<std::int64_t> times;
    std::vector<int> levels;
    for (CameraPoll poll = (*source)->next(milliseconds(0)); poll.event != CameraEvent::end;
         poll = (*source)->next(milliseconds(0))) {
      ASSERT_EQ(poll.event, CameraEvent::frame);
      times.push_back(poll.frame.time);
      levels.push_back(poll.frame.image->bytes[0]);
    }
    EXPECT_EQ(times, (std::vector<std::int64_t>{999999999, 1500000000, 2000000000}));
    EXPECT_EQ(levels, (std::vector<int>{1, 2, 3}));
  }
  EXPECT_EQ((*source)->counters().incomplete, 2u);
}

TEST(ImageFolder, KeepsTheTimeOfTheRecording) {
  const test::TemporaryDirectory directory;
  for (int i = 0; i < 5; ++i) {
    const auto file = directory.path() / (std::to_string(1'000'000'000 + i * 100'000'000) + ".png");
    ASSERT_TRUE(write_png(file, small_picture(8, i)));
  }
  const auto source = open_camera(
      {{"driver", "image_folder"}, {"path", directory.path().string()}, {"speed", "2"}, {"stamps", "live"}});
  ASSERT_TRUE(source) << source.error().text();
  EXPECT_NEAR((*source)->frame_rate(), 20, 1e-9);
  ASSERT_TRUE((*source)->start());
  const CameraFrame first = next_frame(**source);
  for (int i = 1; i < 5; ++i) {
    const CameraFrame frame = next_frame(**source);
    EXPECT_NEAR(static_cast<double>(frame.time - first.time), i * 50e6, 5e6);
  }
  EXPECT_EQ((*source)->next(milliseconds(10)).event, CameraEvent::end);
}

TEST(ImageFolder, SaysWhatIsWrongWithAFolder) {
  const test::TemporaryDirectory directory;
  const SourceOptions source{{"driver", "image_folder"}, {"path", directory.path().string()}};
  EXPECT_NE(error_of(source).find("has no .png or .jpg pictures"), std::string::npos);
  ASSERT_TRUE(write_png(directory.path() / "frame7.png", small_picture(8, 1)));
  EXPECT_NE(error_of(source).find("frame7.png: the name is not a time in ns UTC"), std::string::npos);
  EXPECT_NE(error_of({{"driver", "image_folder"}}).find("the source has no 'path'"), std::string::npos);
  EXPECT_NE(error_of({{"driver", "image_folder"}, {"path", "/nowhere"}}).find("No such file"),
            std::string::npos);
}

}  // namespace
}  // namespace ca2
