/// The driver `t265` against the fake device, in the guest machine (jobs/t265.sh).
#include <grp.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include "drivers/camera/camera_driver.h"
#include "drivers/usb/usb_devices.h"
#include "tests/devices/t265/fake_t265.h"

namespace ca2 {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
using Clock = std::chrono::steady_clock;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// What the driver lists; the others' search of the network takes a second.
std::vector<FoundCamera> listed() {
  for (const CameraDriver* driver : camera_drivers()) {
    if (driver->name == "t265") return driver->list().value();
  }
  return {};
}

/// The fake device, plugged in.
class Fake {
 public:
  Fake(const char* kind, const char* speed, const char* fault = nullptr) {
    const std::string program = environment("CA2_BIN") + "/fake_t265", firmware = environment("FIRMWARE");
    pid_ = ::fork();
    if (pid_ == 0) {
      ::execl(program.c_str(), program.c_str(), kind, speed, firmware.c_str(), fault, nullptr);
      ::_exit(127);
    }
    await(true);
  }
  ~Fake() { unplug(); }

  void unplug() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
    await(false);
  }

 private:
  static void await(bool there) {
    for (int i = 0; i < 200; ++i, std::this_thread::sleep_for(milliseconds(50))) {
      if (listed().empty() != there) return;
    }
    ADD_FAILURE() << (there ? "the fake device did not come" : "the fake device did not go");
  }

  pid_t pid_ = -1;
};

/// The guest is slow: silence is judged more leniently than by default.
SourceOptions source(const SourceOptions& more = {}) {
  SourceOptions out{{"driver", "t265"},
                    {"firmware", environment("FIRMWARE")},
                    {"firmware_sha1", environment("FIRMWARE_SHA1")},
                    {"silence", "4"}};
  for (const auto& [key, value] : more) out[key] = value;
  return out;
}

std::unique_ptr<CameraSource> open(const SourceOptions& more = {}) {
  auto opened = open_camera(source(more));
  EXPECT_TRUE(opened) << opened.error().text();
  return opened ? std::move(*opened) : nullptr;
}

std::string error_of(const SourceOptions& source) {
  const auto opened = open_camera(source);
  return opened ? "" : opened.error().text();
}

/// Every pixel as the device made it; answers the truth in it, ns UTC.
std::int64_t check_picture(const CameraFrame& frame) {
  const Image& image = *frame.image;
  EXPECT_EQ(image.width, test::t265_width);
  EXPECT_EQ(image.height, test::t265_height);
  EXPECT_EQ(image.channels * image.bits, 8);
  int wrong = 0;
  for (int y = 0, i = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x, ++i) {
      const auto expected = test::t265_pixel(frame.stream, static_cast<std::uint32_t>(frame.sequence), x, y);
      wrong += i >= 8 && image.bytes[static_cast<std::size_t>(i)] != expected;
    }
  }
  EXPECT_EQ(wrong, 0) << "pixels, picture " << frame.sequence << ", imager " << frame.stream;
  std::int64_t truth = 0;
  std::memcpy(&truth, image.bytes.data(), sizeof truth);
  return truth;
}

/// Takes `pairs` pairs and checks each picture, its time, and that pairs belong together.
void check_pairs(CameraSource& camera, int pairs) {
  std::map<std::uint64_t, std::set<int>> seen;
  std::map<std::uint64_t, std::int64_t> times;
  int complete = 0;
  double worst = 0, worst_sigmas = 0;
  const auto end = Clock::now() + seconds(90);
  while (complete < pairs) {
    ASSERT_LT(Clock::now(), end) << "only " << complete << " pairs";
    const CameraPoll poll = camera.next(milliseconds(500));
    ASSERT_NE(poll.event, CameraEvent::lost) << poll.reason;
    if (poll.event != CameraEvent::frame) continue;
    const std::int64_t truth = check_picture(poll.frame);
    const double error = static_cast<double>(poll.frame.time - truth);
    worst = std::max(worst, std::abs(error));
    worst_sigmas = std::max(worst_sigmas, std::abs(error) / static_cast<double>(poll.frame.time_sigma));
    EXPECT_TRUE(seen[poll.frame.sequence].insert(poll.frame.stream).second) << "twice the same";
    const auto [at, first] = times.emplace(poll.frame.sequence, poll.frame.time);
    // The mapping may be refined between the two.
    EXPECT_LT(std::abs(poll.frame.time - at->second), 10 * poll.frame.time_sigma);
    complete += seen[poll.frame.sequence].size() == 2;
  }
  std::printf("%d pairs, stamps within %.3f ms of the truth, %.1f sigma\n", pairs, worst * 1e-6,
              worst_sigmas);
  EXPECT_LT(worst_sigmas, 6);
}

/// Polls until the device is lost; answers why.
std::string wait_for_loss(CameraSource& camera, milliseconds patience) {
  const auto end = Clock::now() + patience;
  while (Clock::now() < end) {
    const CameraPoll poll = camera.next(milliseconds(500));
    if (poll.event == CameraEvent::lost) return poll.reason;
  }
  return "";
}

TEST(T265, BootsTellsItsCalibrationAndStreams) {
  const Fake fake("loader", "super");
  ASSERT_EQ(listed().at(0).description.find("Intel RealSense T265"), 0u);
  EXPECT_NE(listed().at(0).description.find("without firmware"), std::string::npos);
  const auto camera = open();
  ASSERT_TRUE(camera);
  EXPECT_NE(camera->description().find("serial 908412110993, firmware 0.2.0.951"), std::string::npos)
      << camera->description();
  EXPECT_EQ(listed().at(0).id, test::t265_serial);
  EXPECT_EQ(listed().at(0).problem, "");

  ASSERT_EQ(camera->streams().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const CameraStream& stream = camera->streams()[i];
    const test::FakeFisheye& truth = test::t265_fisheyes[i];
    EXPECT_EQ(stream.name, i == 0 ? "left" : "right");
    ASSERT_TRUE(stream.intrinsics);
    const double expected[] = {truth.fx,   truth.fy,   truth.cx,   truth.cy,
                               truth.k[0], truth.k[1], truth.k[2], truth.k[3]};
    for (int k = 0; k < 8; ++k) EXPECT_EQ(stream.intrinsics->parameters[k], expected[k]);
  }
  // The right imager is 64 mm to the left one's right and turned by 10 mrad about y.
  const Pose& T = *camera->streams()[1].T_first_this;
  EXPECT_NEAR(T.t.x(), 0.064, 1e-6);
  EXPECT_NEAR(T.t.y(), -0.0005, 1e-6);
  EXPECT_LT((so3_log(T.R) - Eigen::Vector3d(0, 0.01, 0)).norm(), 1e-5);

  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 15);
  EXPECT_EQ(camera->counters().incomplete, 0u);
  EXPECT_EQ(camera->counters().missed, 0u);

  // Stopped and started again, everything is set up anew.
  camera->stop();
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 3);
}

/// The udev rules: the daemon's group may use the device, with and without firmware, and nobody else.
TEST(T265, IsForItsGroupOnly) {
  const group* ours = ::getgrnam("ca2");
  ASSERT_TRUE(ours);
  for (const char* kind : {"loader", "camera"}) {
    const Fake fake(kind, "super");
    const UsbId ids[] = {{0x03e7, 0x2150}, {0x8087, 0x0b37}};
    const auto found = list_usb_devices(ids);
    ASSERT_TRUE(found && found->size() == 1);
    char node[64];
    std::snprintf(node, sizeof node, "/dev/bus/usb/%03d/%03d", std::atoi(found->front().port.c_str()),
                  found->front().address);
    struct stat status {};
    for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(milliseconds(50))) {
      ASSERT_EQ(::stat(node, &status), 0) << node;
      if (status.st_gid == ours->gr_gid) break;
    }
    EXPECT_EQ(status.st_gid, ours->gr_gid) << kind;
    EXPECT_EQ(status.st_mode & 0777, 0660u) << kind;
  }
}

TEST(T265, WorksOnUsb2WhenItIsUpAlready) {
  const Fake fake("camera", "high");
  EXPECT_NE(listed().at(0).problem.find("USB 2"), std::string::npos);
  const auto camera = open({{"id", test::t265_serial}, {"firmware", "/nowhere"}});
  ASSERT_TRUE(camera);
  EXPECT_NE(camera->description().find("480 Mbit/s"), std::string::npos) << camera->description();
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 3);
}

TEST(T265, ExposureIsSetAndReadBack) {
  const Fake fake("camera", "super");
  const auto camera = open({{"exposure_us", "4321"}, {"gain_db", "6.02"}});
  ASSERT_TRUE(camera);
  ASSERT_TRUE(camera->start());
  const auto reads = [&](const std::string& exposure, const std::string& gain) {
    const auto end = Clock::now() + seconds(20);
    while (Clock::now() < end) {
      camera->next(milliseconds(500));
      const auto controls = camera->controls();
      EXPECT_EQ(controls.at("exposure_us").problem, "");
      if (controls.at("exposure_us").value == exposure && controls.at("gain_db").value == gain) return true;
    }
    return false;
  };
  EXPECT_TRUE(reads("4321", "6.02"));
  EXPECT_TRUE(camera->set_control("exposure_us", "12000"));
  EXPECT_TRUE(reads("12000", "6.02"));
  EXPECT_FALSE(camera->set_control("exposure_us", "20000"));
  EXPECT_FALSE(camera->set_control("focus", "1"));
}

TEST(T265, WhatCannotWorkIsSaid) {
  EXPECT_NE(error_of(source()).find("none is connected"), std::string::npos);
  EXPECT_NE(error_of(source({{"id", "000000000000"}})).find("'000000000000' is not connected"),
            std::string::npos);
  {
    const Fake fake("loader", "super");
    const std::string text = error_of({{"driver", "t265"}});
    EXPECT_NE(text.find("waits for its firmware"), std::string::npos) << text;
    EXPECT_NE(text.find("target-0.2.0.951.mvcmd"), std::string::npos) << text;
    const std::string wrong = error_of(source({{"firmware_sha1", "0123"}}));
    EXPECT_NE(wrong.find("is not the firmware"), std::string::npos) << wrong;
  }
  {
    const Fake fake("camera", "super", "uncalibrated");
    EXPECT_NE(error_of(source()).find("lost its factory calibration"), std::string::npos);
  }
  {
    const Fake fake("camera", "super", "nonsense");
    EXPECT_NE(error_of(source()).find("factory calibration"), std::string::npos);
  }
  const Fake fake("camera", "super");
  const auto first = open();
  const std::string text = error_of(source());
  EXPECT_NE(text.find("another program is using it"), std::string::npos) << text;
}

TEST(T265, LeftStreamingByAProgramThatWasKilled) {
  const Fake fake("camera", "super", "busy");
  std::this_thread::sleep_for(milliseconds(300));  // stale pictures wait to be read
  const auto camera = open();
  ASSERT_TRUE(camera);
  const auto started = camera->start();
  ASSERT_TRUE(started) << started.error().text();
  check_pairs(*camera, 3);
}

/// A device that answers nothing, or nothing that makes sense, is restarted and boots again.
TEST(T265, HungBeforeItIsOpened) {
  for (const char* fault : {"silent", "stammers"}) {
    const Fake fake("camera", "super", fault);
    const auto camera = open();
    ASSERT_TRUE(camera) << fault;
    ASSERT_TRUE(camera->start());
    check_pairs(*camera, 2);
  }
}

TEST(T265, HangsWhileStreaming) {
  const Fake fake("camera", "super", "hangs=4");
  auto camera = open();
  ASSERT_TRUE(camera);
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 4);
  const auto begin = Clock::now();
  EXPECT_EQ(wait_for_loss(*camera, seconds(20)).find("no picture for "), 0u);
  EXPECT_LT(Clock::now() - begin, seconds(10));
  camera.reset();
  camera = open();
  ASSERT_TRUE(camera);
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 2);
}

TEST(T265, DamagedMessagesAreCountedAndNeverUsed) {
  const Fake fake("camera", "super", "noise");
  const auto camera = open();
  ASSERT_TRUE(camera);
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 10);
  EXPECT_GE(camera->counters().incomplete, 10u);
  EXPECT_EQ(camera->counters().missed, 0u);
}

TEST(T265, GapsAreCounted) {
  const Fake fake("camera", "super", "skips");
  const auto camera = open();
  ASSERT_TRUE(camera);
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 6);
  EXPECT_GE(camera->counters().missed, 4u);
}

TEST(T265, EachImagerAnswersForItsOwnGaps) {
  const Fake fake("camera", "super", "limps");
  const auto camera = open();
  ASSERT_TRUE(camera);
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 6);
  const CameraCounters left = camera->counters_of(0), right = camera->counters_of(1);
  EXPECT_EQ(left.missed, 0u);
  EXPECT_GE(right.missed, 2u);
  camera->stop();
  EXPECT_EQ(camera->counters().missed, camera->counters_of(0).missed + camera->counters_of(1).missed);
  EXPECT_EQ(camera->counters().frames, camera->counters_of(0).frames + camera->counters_of(1).frames);
}

TEST(T265, StopsByItself) {
  for (const auto& [fault, reason] : std::map<const char*, const char*>{
           {"stops=3", "the device says DEVICE_STOPPED"}, {"empty=3", "an empty message"}}) {
    const Fake fake("camera", "super", fault);
    const auto camera = open();
    ASSERT_TRUE(camera);
    ASSERT_TRUE(camera->start());
    EXPECT_EQ(wait_for_loss(*camera, seconds(20)).find(reason), 0u) << fault;
  }
}

TEST(T265, UnpluggedWhileStreamingAndPluggedInAgain) {
  std::unique_ptr<CameraSource> camera;
  {
    Fake fake("camera", "super");
    camera = open();
    ASSERT_TRUE(camera);
    ASSERT_TRUE(camera->start());
    check_pairs(*camera, 2);
    const auto begin = Clock::now();
    std::thread puller([&] { fake.unplug(); });
    EXPECT_NE(wait_for_loss(*camera, seconds(20)), "");
    EXPECT_LT(Clock::now() - begin, seconds(3));
    puller.join();
  }
  camera.reset();
  EXPECT_NE(error_of(source()).find("none is connected"), std::string::npos);
  const Fake fake("loader", "super");
  camera = open();
  ASSERT_TRUE(camera);
  ASSERT_TRUE(camera->start());
  check_pairs(*camera, 2);
}

TEST(T265, AnInterruptionEndsTheWait) {
  const Fake fake("camera", "super");
  const auto camera = open();
  ASSERT_TRUE(camera);
  std::thread other([&] {
    std::this_thread::sleep_for(milliseconds(100));
    camera->interrupt();
  });
  EXPECT_EQ(camera->next(seconds(30)).event, CameraEvent::stopped);
  other.join();
}

}  // namespace
}  // namespace ca2
