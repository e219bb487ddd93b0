/// @file snap, record cameras and sensors with cameras that need no hardware.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "drivers/camera/camera_driver.h"
#include "tests/support/temporary_directory.h"
#include "tests/tools/ca2/program.h"

namespace ca2 {
namespace {

using namespace ca2::test;

TEST(CameraCommands, SnapWritesThePictureAsItIs) {
  const TemporaryDirectory directory;
  const std::string file = directory / "snap.png";
  const Outcome run = run_ca2(
      {"snap", "pattern:pattern=ramp,format=Mono16,width=301,height=40,frame_rate=50", file, "--skip", "2"});
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_NE(run.output.find("snap.png: 301 x 40, grey, 16 bits, virtual camera"), std::string::npos)
      << run.output;
  const auto image = read_png(file);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->bits, 16);
  const Image grey = to_grey8(*image);
  for (std::size_t i = 1; i < 301; ++i) ASSERT_EQ(grey.bytes[i], (grey.bytes[0] + i) & 0xff);
}

TEST(CameraCommands, SnapSaysWhatIsWrong) {
  const TemporaryDirectory directory;
  const std::string file = directory / "snap.png";
  const auto errors = [&](const std::vector<std::string>& arguments, int status) {
    std::vector<std::string> all{"snap"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome run = run_ca2(all);
    EXPECT_EQ(run.status, status) << run.errors;
    return run.errors;
  };
  EXPECT_NE(errors({"patern", file}, 78).find("did you mean 'pattern'?"), std::string::npos);
  EXPECT_NE(errors({"pattern:widht=3", file}, 78).find("did you mean 'width'?"), std::string::npos);
  EXPECT_NE(errors({"pattern:width", file}, 64).find("'width' is no option"), std::string::npos);
  EXPECT_NE(errors({"pattern", file, "--imager", "left"}, 78).find("leave 'imager' out"), std::string::npos);
  EXPECT_NE(errors({"v4l2:id=/dev/null", file}, 78).find("/dev/null: is no V4L2 device"), std::string::npos);
  EXPECT_NE(errors({"v4l2:id=usb-nothing", file}, 69).find("cannot open it: No such file"),
            std::string::npos);
  EXPECT_NE(errors({"pattern", "/nowhere/x.png"}, 73).find("/nowhere/x.png"), std::string::npos);
}

TEST(CameraCommands, RecordedPicturesAreARecordingsAndPlayAgain) {
  const TemporaryDirectory directory;
  const std::string output = directory / "recording";
  const Outcome run =
      run_ca2({"record", "cameras", "left=pattern:id=a,pattern=ramp,frame_rate=20,width=64,height=48",
               "right=pattern:id=b,frame_rate=20,width=64,height=48", "--output", output, "--duration", "1.5",
               "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const auto report = nlohmann::json::parse(run.output);
  for (const std::string name : {"left", "right"}) {
    const auto folder =
        open_camera({{"driver", "image_folder"}, {"path", output + "/cameras/" + name}, {"speed", "0"}});
    ASSERT_TRUE(folder) << folder.error().text();
    ASSERT_TRUE((*folder)->start());
    int pictures = 0;
    std::int64_t last = 0;
    for (;; ++pictures) {
      const CameraPoll poll = (*folder)->next(std::chrono::milliseconds(0));
      if (poll.event != CameraEvent::frame) break;
      EXPECT_GT(poll.frame.time, last);
      last = poll.frame.time;
    }
    EXPECT_EQ(pictures, report[name]["written"].get<int>());
    EXPECT_GT(pictures, 5);
  }
  const Outcome again =
      run_ca2({"record", "cameras", "left=pattern", "--output", output, "--duration", "0.1"});
  EXPECT_EQ(again.status, 73);
  EXPECT_NE(again.errors.find("has pictures already"), std::string::npos) << again.errors;
}

TEST(CameraCommands, SensorsListsCamerasAsJson) {
  const Outcome run = run_ca2({"sensors", "--cameras", "--json"});
  // What is there depends on the machine; what is said of it does not.
  ASSERT_TRUE(run.status == 0 || run.status == 69) << run.errors;
  const auto report = nlohmann::json::parse(run.output);
  ASSERT_TRUE(report["cameras"].is_array());
  EXPECT_EQ(report["cameras"].empty(), run.status == 69);
  for (const auto& camera : report["cameras"]) {
    for (const char* key : {"driver", "id", "description", "source", "problem"})
      EXPECT_TRUE(camera.contains(key)) << key;
  }
}

}  // namespace
}  // namespace ca2
