/// The driver `v4l2` against v4l2loopback and vivid, in the guest machine (jobs/v4l2.sh).
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <random>

#include "core/io/jpeg.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/camera/pixel_formats/pixel_format.h"
#include "drivers/camera/v4l2/device.h"
#include "tests/devices/v4l2/loopback_writer.h"

namespace ca2 {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
using Clock = std::chrono::steady_clock;

/// v4l2loopback mixes up what it was with what it is when it gets another writer: each format has a device.
std::string loopback(int number) {
  return "/dev/video" + std::to_string(number);
}
constexpr const char* vivid = "platform-vivid.0-video-index0";

std::unique_ptr<CameraSource> opened(SourceOptions source) {
  source["driver"] = "v4l2";
  auto camera = open_camera(source);
  if (!camera) {
    ADD_FAILURE() << camera.error().text();
    return nullptr;
  }
  if (const auto started = (*camera)->start(); !started) {
    ADD_FAILURE() << started.error().text();
    return nullptr;
  }
  return std::move(*camera);
}

/// The next picture; none after 10 s (an emulated processor is slow), or when the camera is lost.
std::optional<CameraFrame> next_frame(CameraSource& camera) {
  const auto end = Clock::now() + seconds(10);
  while (Clock::now() < end) {
    CameraPoll poll = camera.next(milliseconds(500));
    if (poll.event == CameraEvent::frame) return poll.frame;
    if (poll.event == CameraEvent::lost) {
      ADD_FAILURE() << "lost: " << poll.reason;
      return std::nullopt;
    }
  }
  ADD_FAILURE() << "no picture";
  return std::nullopt;
}

std::vector<std::uint8_t> random_picture(const PixelFormat& format, int width, int height) {
  std::mt19937 random(1);
  if (format.packing == PixelPacking::jpeg) {
    Image image{width, height, 3, 8, {}};
    for (int i = 0; i < width * height * 3; ++i) image.bytes.push_back(static_cast<std::uint8_t>(i / 100));
    const std::string jpeg = encode_jpeg(image, 90).value();
    return {jpeg.begin(), jpeg.end()};
  }
  std::vector<std::uint8_t> bytes(format.tight_size(width, height));
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

TEST(Loopback, OurPicturesArrivePixelExact) {
  int number = 0;
  for (const char* name : {"Mono8", "YUV422_8", "NV12", "Mono16", "BayerBG8", "RGB8", "MJPG"}) {
    const PixelFormat& format = *find_pixel_format(name);
    constexpr int width = 320, height = 240;
    const auto bytes = random_picture(format, width, height);
    const std::size_t stride = format.packing == PixelPacking::jpeg ? 0
                               : format.colour == PixelColour::nv12 ? width
                                                                    : bytes.size() / height;
    const std::string node = loopback(number++);
    const test::LoopbackWriter writer(node, format.fourcc, width, height, stride, bytes);
    for (const std::string kind : {"grey", "colour"}) {
      const auto camera = opened({{"id", node}, {"format", name}, {"picture", kind}});
      ASSERT_TRUE(camera) << name;
      EXPECT_EQ(camera->streams()[0].width, width);
      const auto frame = next_frame(*camera);
      ASSERT_TRUE(frame) << name;
      const auto expected = to_image({&format, width, height, 0, bytes},
                                     kind == "grey" ? PictureKind::grey : PictureKind::colour);
      ASSERT_TRUE(expected);
      EXPECT_TRUE(frame->image->bytes == expected->bytes) << name << " " << kind;
      EXPECT_EQ(frame->image->bits, expected->bits);
    }
  }
}

TEST(Loopback, WrongWishesAreToldWithWhatThereIs) {
  const PixelFormat& format = *find_pixel_format("Mono8");
  const std::string node = loopback(7);
  const test::LoopbackWriter writer(node, format.fourcc, 320, 240, 320, random_picture(format, 320, 240));
  const auto other = open_camera({{"driver", "v4l2"}, {"id", node}, {"format", "MJPG"}});
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().text().find("it has GREY"), std::string::npos) << other.error().text();
  const auto larger = open_camera({{"driver", "v4l2"}, {"id", node}, {"width", "640"}, {"height", "480"}});
  ASSERT_FALSE(larger);
  EXPECT_NE(larger.error().text().find("320x240"), std::string::npos) << larger.error().text();
}

TEST(Vivid, IsListedByItsStableName) {
  bool listed = false;
  for (const FoundCamera& camera : list_cameras().cameras) {
    if (camera.id != vivid) continue;
    listed = true;
    EXPECT_EQ(camera.problem, "");
    EXPECT_NE(camera.description.find("YUYV"), std::string::npos) << camera.description;
  }
  EXPECT_TRUE(listed);
}

TEST(Vivid, StreamsInTimeAndCountsWhatIsMissing) {
  const auto camera = opened({{"id", vivid}, {"width", "320"}, {"height", "180"}, {"frame_rate", "10"}});
  ASSERT_TRUE(camera);
  EXPECT_NEAR(camera->frame_rate(), 10, 0.1);
  std::int64_t first = 0, last = 0;
  std::uint64_t first_number = 0, last_number = 0;
  for (int i = 0; i < 20; ++i) {
    const auto frame = next_frame(*camera);
    ASSERT_TRUE(frame);
    if (i == 0) {
      first = frame->time;
      first_number = frame->sequence;
    }
    EXPECT_TRUE(i == 0 || frame->time > last);
    last = frame->time;
    last_number = frame->sequence;
  }
  EXPECT_NEAR(static_cast<double>(last - first), 1e8 * static_cast<double>(last_number - first_number), 5e7);
  EXPECT_EQ(last_number - first_number + 1, 20 + camera->counters().missed);
  EXPECT_EQ(camera->counters().incomplete, 0u);  // the first two are left out, not lost
}

TEST(Vivid, ControlsAreWrittenInOrderReadBackAndLimited) {
  auto camera = opened({{"id", vivid}, {"controls", "gain=120 brightness=77"}});
  ASSERT_TRUE(camera);
  auto controls = camera->controls();
  EXPECT_EQ(controls["brightness"].value, "77");
  // The camera's automatic gain is on by default, and would refuse a value.
  EXPECT_EQ(controls["gain"].value, "120");
  EXPECT_EQ(controls["gain_automatic"].value, "0");
  const auto refused = camera->set_control("brightness", "1000");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text().find("must be from 0 to 255"), std::string::npos)
      << refused.error().text();
  EXPECT_NE(camera->set_control("brigthness", "1").error().text().find("did you mean 'brightness'?"),
            std::string::npos);
  ASSERT_TRUE(camera->set_control("brightness", "99"));
  for (int i = 0; i < 100 && camera->controls()["brightness"].value != "99"; ++i) {
    std::this_thread::sleep_for(milliseconds(20));
  }
  EXPECT_EQ(camera->controls()["brightness"].value, "99");
  camera.reset();
  const auto wrong = open_camera({{"driver", "v4l2"}, {"id", vivid}, {"controls", "zoom=1"}});
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("unknown key 'zoom'"), std::string::npos) << wrong.error().text();
}

TEST(Vivid, ACameraInUseIsSaidToBe) {
  const auto camera = opened({{"id", vivid}});
  ASSERT_TRUE(camera);
  const auto second = open_camera({{"driver", "v4l2"}, {"id", vivid}});
  const std::string text = second ? (*second)->start().error().text() : second.error().text();
  EXPECT_NE(text.find("another program uses the camera: stop it first"), std::string::npos) << text;
}

/// Presses one of vivid's buttons, or sets another control that is its own.
void set_by_name(const std::string& name, int value) {
  const auto device = V4l2Device::open(v4l2_node_of(vivid));
  ASSERT_TRUE(device);
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (device->call(VIDIOC_QUERYCTRL, &query) == 0) {
    if (name == reinterpret_cast<const char*>(query.name)) {
      v4l2_control control{query.id, value};
      ASSERT_EQ(device->call(VIDIOC_S_CTRL, &control), 0);
      return;
    }
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  FAIL() << "vivid has no control " << name;
}

TEST(Vivid, DroppedBuffersAreCounted) {
  const auto camera = opened({{"id", vivid}, {"width", "320"}, {"height", "180"}, {"frame_rate", "20"}});
  ASSERT_TRUE(camera);
  set_by_name("Percentage of Dropped Buffers", 50);
  std::uint64_t first = 0, last = 0;
  for (int i = 0; i < 20; ++i) {
    const auto frame = next_frame(*camera);
    ASSERT_TRUE(frame);
    if (i == 0) first = frame->sequence;
    last = frame->sequence;
  }
  set_by_name("Percentage of Dropped Buffers", 0);
  EXPECT_GT(camera->counters().missed, 3u);
  EXPECT_LE(last - first - 19, camera->counters().missed);
}

void write_sysfs(const char* file, const char* text) {
  std::ofstream stream(file);
  stream << text << std::flush;
  EXPECT_TRUE(stream.good()) << file;
}

TEST(Vivid, UnpluggingIsNoticedAtOnceAndTheCameraComesBackByItsName) {
  auto camera = opened({{"id", vivid}});
  ASSERT_TRUE(camera);
  ASSERT_TRUE(next_frame(*camera));
  set_by_name("Disconnect", 1);
  const auto unplugged = Clock::now();
  CameraPoll poll;
  do {
    poll = camera->next(milliseconds(5000));
  } while (poll.event == CameraEvent::frame);
  EXPECT_EQ(poll.event, CameraEvent::lost);
  EXPECT_EQ(poll.reason, "unplugged");
  EXPECT_LT(Clock::now() - unplugged, seconds(2));
  EXPECT_EQ(camera->counters().incomplete, 0u);  // it is gone, no picture is
  camera->stop();
  camera.reset();
  // vivid plugs itself in again when nobody has it open: it is really taken away.
  write_sysfs("/sys/bus/platform/drivers/vivid/unbind", "vivid.0");
  const auto gone = open_camera({{"driver", "v4l2"}, {"id", vivid}});
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::unavailable) << gone.error().text();
  write_sysfs("/sys/bus/platform/drivers/vivid/bind", "vivid.0");
  for (int i = 0; i < 100 && !camera; ++i, std::this_thread::sleep_for(milliseconds(100))) {
    auto again = open_camera({{"driver", "v4l2"}, {"id", vivid}});
    if (again && (*again)->start()) camera = std::move(*again);
  }
  ASSERT_TRUE(camera);
  EXPECT_TRUE(next_frame(*camera));
}

}  // namespace
}  // namespace ca2
