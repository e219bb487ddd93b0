/// The Aravis source against a GigE Vision camera in another process, over true GVCP and GVSP in a network of
/// its own.
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "drivers/camera/camera_driver.h"
#include "drivers/camera/pattern/board_picture.h"
#include "drivers/camera/pixel_formats/pixel_format.h"
#include "tests/support/gige_camera.h"
#include "tests/support/private_network.h"

namespace ca2 {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr const char* first_address = "127.0.0.2";
constexpr const char* second_address = "127.0.0.3";

class Gige : public testing::Test {
 protected:
  static void SetUpTestSuite() { private_network_ = test::enter_private_network(3); }
  void SetUp() override {
    if (!private_network_) GTEST_SKIP() << "no right to make a network namespace: run as root";
  }

 private:
  static inline bool private_network_ = false;
};

/// Bytes of a rendered board as a camera sends them in a format: samples of the format's depth, colours of
/// the mosaic as they come.
std::string board_bytes(const std::string& format, int width, int height) {
  const Board board{find_board_type("checkerboard"), 8, 6, 0.04, 0, 0, {}, {}};
  Camera camera{find_camera_model("pinhole_radtan"), CameraParameters(8), width, height};
  camera.parameters << 0.9 * width, 0.9 * width, 0.5 * width, 0.5 * height, 0, 0, 0, 0;
  const Pose pose{so3_exp(Eigen::Vector3d(0.3, -0.2, 0.1)), {0.01, 0.02, 0.5}};
  std::string bytes;
  for (const float grey : board_picture(board, camera, pose).pixels) {
    if (format == "Mono16") {
      const int value = static_cast<int>(grey * 257);
      bytes += static_cast<char>(value & 0xff);
      bytes += static_cast<char>(value >> 8);
    } else {
      bytes.append(format == "RGB8" ? 3 : 1, static_cast<char>(static_cast<int>(grey)));
    }
  }
  return bytes;
}

bool same(const Image& image, const std::string& bytes) {
  return std::equal(image.bytes.begin(), image.bytes.end(), bytes.begin(), bytes.end(),
                    [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); });
}

std::unique_ptr<CameraSource> opened(const SourceOptions& more) {
  SourceOptions source{{"driver", "aravis"}, {"id", first_address}};
  for (const auto& [key, value] : more) source[key] = value;
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

/// The next picture; none after 3 s, or when the camera is lost.
std::optional<CameraFrame> next_frame(CameraSource& camera) {
  const auto end = Clock::now() + std::chrono::seconds(3);
  while (Clock::now() < end) {
    CameraPoll poll = camera.next(milliseconds(500));
    if (poll.event == CameraEvent::frame) return poll.frame;
    if (poll.event == CameraEvent::lost) return std::nullopt;
  }
  return std::nullopt;
}

TEST_F(Gige, RenderedBoardArrivesPixelExact) {
  for (const std::string name : {"Mono8", "Mono16", "BayerRG8", "BayerGB8", "RGB8"}) {
    const std::string bytes = board_bytes(name, 640, 480);
    const test::GigeCamera device(first_address, "BOARD", bytes);
    for (const std::string kind : {"grey", "colour"}) {
      const auto camera = opened(
          {{"format", name}, {"width", "640"}, {"height", "480"}, {"frame_rate", "20"}, {"picture", kind}});
      ASSERT_TRUE(camera);
      EXPECT_EQ(camera->streams()[0].format, name);
      const auto frame = next_frame(*camera);
      ASSERT_TRUE(frame);
      const RawPicture raw{find_pixel_format(name),
                           640,
                           480,
                           0,
                           {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}};
      const auto expected = to_image(raw, kind == "grey" ? PictureKind::grey : PictureKind::colour);
      ASSERT_EQ(frame->image->bytes.size(), expected->bytes.size()) << name;
      EXPECT_TRUE(frame->image->bytes == expected->bytes) << name << " " << kind;
    }
  }
}

TEST_F(Gige, FourMegapixelsAtTwentyFivePerSecondWithoutLoss) {
  const test::GigeCamera device(first_address, "LARGE");
  const auto camera = opened({{"width", "2048"},
                              {"height", "2048"},
                              {"frame_rate", "25"},
                              {"packet_size", "8192"},
                              {"silence", "3"}});
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->streams()[0].width, 2048);
  const auto begin = Clock::now();
  std::uint64_t first = 0, last = 0;
  int frames = 0;
  while (Clock::now() - begin < std::chrono::seconds(4)) {
    const auto frame = next_frame(*camera);
    ASSERT_TRUE(frame);
    (frames++ == 0 ? first : last) = frame->sequence;
  }
  const CameraCounters counters = camera->counters();
  EXPECT_EQ(counters.incomplete, 0u);
  EXPECT_EQ(counters.missed, 0u);
  EXPECT_EQ(counters.overrun, 0u);
  // The camera leaves 0 out when its count wraps around.
  EXPECT_EQ(static_cast<std::uint16_t>(last - first + (last < first ? 65535 : 0)), frames - 1);
  RecordProperty("frames_in_4_s", frames);
  // The camera shares the processor with the other tests: it may itself fall behind its rate.
  EXPECT_GT(frames, 25);
}

TEST_F(Gige, LostPacketsMakeIncompletePicturesThatAreCountedAndNeverShown) {
  const std::string bytes = board_bytes("Mono8", 512, 512);
  const test::GigeCamera device(first_address, "LOSSY", bytes, 0.002);
  const auto camera = opened({{"width", "512"}, {"height", "512"}, {"frame_rate", "25"}, {"silence", "3"}});
  ASSERT_TRUE(camera);
  for (int i = 0; i < 50; ++i) {
    const CameraPoll poll = camera->next(milliseconds(1000));
    ASSERT_NE(poll.event, CameraEvent::lost) << poll.reason;
    if (poll.event != CameraEvent::frame) continue;
    ASSERT_TRUE(same(*poll.frame.image, bytes));
  }
  const CameraCounters counters = camera->counters();
  EXPECT_GT(counters.incomplete, 3u);  // 191 packets each: 32 % of the pictures
  EXPECT_GT(counters.frames, counters.incomplete / 2);
}

/// Delivered pictures from the first one on, and what the camera's own numbers say there should have been.
struct Tally {
  std::uint64_t begin = 0;  ///< lost until the first one
  std::uint64_t due = 0, delivered = 0;
  std::optional<std::uint64_t> last;

  static std::uint64_t lost(const CameraSource& camera) {
    const CameraCounters counters = camera.counters();
    return counters.incomplete + counters.missed + counters.overrun;
  }
  void add(const CameraSource& camera, const CameraFrame& frame) {
    if (!last) begin = lost(camera);
    // The camera leaves 0 out when its count wraps around.
    due += last ? (frame.sequence + 65535 - *last) % 65535 : 1;
    ++delivered;
    last = frame.sequence;
  }
};

TEST_F(Gige, EveryPictureThatIsNotDeliveredIsCountedOnce) {
  // Three packets of data in each: every tenth picture comes without its first packet, which has its number.
  const test::GigeCamera device(first_address, "LOSSY", std::string(64 * 64, '\x80'), 0.1);
  const auto camera = opened({{"width", "64"}, {"height", "64"}, {"frame_rate", "50"}, {"silence", "3"}});
  ASSERT_TRUE(camera);
  Tally tally;
  while (tally.delivered < 60) {
    const auto frame = next_frame(*camera);
    ASSERT_TRUE(frame);
    tally.add(*camera, *frame);
  }
  EXPECT_GT(tally.due, tally.delivered);
  EXPECT_EQ(Tally::lost(*camera) - tally.begin, tally.due - tally.delivered);
}

TEST_F(Gige, AReaderWhoComesLateLosesPicturesNotPackets) {
  const test::GigeCamera device(first_address, "LATE");
  const auto camera =
      opened({{"width", "512"}, {"height", "512"}, {"frame_rate", "50"}, {"silence", "3"}, {"buffers", "3"}});
  ASSERT_TRUE(camera);
  Tally tally;
  while (tally.delivered < 30) {
    const auto frame = next_frame(*camera);
    ASSERT_TRUE(frame);
    tally.add(*camera, *frame);
    if (tally.delivered == 10) std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  EXPECT_GT(tally.due, tally.delivered);
  EXPECT_GT(camera->counters().overrun, 0u);
  EXPECT_EQ(Tally::lost(*camera) - tally.begin, tally.due - tally.delivered);
}

/// What a supervisor does.
std::unique_ptr<CameraSource> reopened(const SourceOptions& source, Clock::time_point end) {
  while (Clock::now() < end) {
    auto camera = open_camera(source);
    if (camera && (*camera)->start()) return std::move(*camera);
  }
  return nullptr;
}

TEST_F(Gige, ADeadCameraIsNoticedInThreeFramePeriodsAndBackInTenSeconds) {
  test::GigeCamera device(first_address, "MORTAL");
  const SourceOptions source{{"driver", "aravis"}, {"id", first_address}, {"frame_rate", "5"}};
  auto camera = opened(source);
  ASSERT_TRUE(camera);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(next_frame(*camera));
  device.kill();
  const auto killed = Clock::now();
  CameraPoll poll;
  do {
    poll = camera->next(milliseconds(100));
  } while (poll.event != CameraEvent::lost && Clock::now() - killed < std::chrono::seconds(10));
  const duration<double> noticed = Clock::now() - killed;
  ASSERT_EQ(poll.event, CameraEvent::lost);
  EXPECT_NE(poll.reason.find("no picture for"), std::string::npos) << poll.reason;
  EXPECT_LT(noticed.count(), 0.6 + 0.1);  // 0.1: the host is busy with other tests
  EXPECT_EQ(camera->next(milliseconds(0)).event, CameraEvent::lost);
  // Whoever lets go of it does not wait for a camera that will not answer.
  const auto closing = Clock::now();
  camera->stop();
  camera.reset();
  EXPECT_LT(Clock::now() - closing, milliseconds(500));
  device.start();
  const auto returned = Clock::now();
  camera = reopened(source, returned + std::chrono::seconds(10));
  ASSERT_TRUE(camera);
  EXPECT_TRUE(next_frame(*camera));
  const duration<double> back = Clock::now() - returned;
  EXPECT_LT(back.count(), 10);
  RecordProperty("noticed_ms", static_cast<int>(1e3 * noticed.count()));
  RecordProperty("back_ms", static_cast<int>(1e3 * back.count()));
}

TEST_F(Gige, ControlsOfAFrozenCameraHoldNobodyUp) {
  test::GigeCamera device(first_address, "FROZEN");
  const auto camera = opened({{"frame_rate", "5"}});
  ASSERT_TRUE(camera);
  ASSERT_TRUE(next_frame(*camera));
  device.freeze();
  const auto frozen = Clock::now();
  EXPECT_TRUE(camera->set_control("exposure_us", "5000"));
  EXPECT_LT(Clock::now() - frozen, milliseconds(50));
  while (camera->next(milliseconds(50)).event != CameraEvent::lost &&
         Clock::now() - frozen < std::chrono::seconds(5)) {
  }
  EXPECT_LT(Clock::now() - frozen, milliseconds(700));
}

TEST_F(Gige, TwoCamerasAtOnce) {
  const std::string one = board_bytes("Mono8", 512, 512);
  const std::string two(512 * 512, '\x40');
  const test::GigeCamera first(first_address, "ONE", one), second(second_address, "TWO", two);
  const auto shows = [](const char* id, const std::string& bytes) {
    const auto camera =
        opened({{"id", id}, {"width", "512"}, {"height", "512"}, {"frame_rate", "10"}, {"silence", "3"}});
    if (!camera) return -1;
    int frames = 0;
    for (; frames < 15; ++frames) {
      const auto frame = next_frame(*camera);
      if (!frame || !same(*frame->image, bytes)) return -1;
    }
    return camera->counters().missed == 0 && camera->counters().incomplete == 0 ? frames : -2;
  };
  // One by address, the other by serial number.
  auto other = std::async(std::launch::async, shows, "TWO", two);
  EXPECT_EQ(shows(first_address, one), 15);
  EXPECT_EQ(other.get(), 15);
  const auto found = list_cameras().cameras;
  std::vector<std::string> ids;
  for (const FoundCamera& camera : found) {
    if (camera.driver == "aravis") ids.push_back(camera.id);
  }
  EXPECT_EQ(ids, (std::vector<std::string>{"Aravis-Fake-ONE", "Aravis-Fake-TWO"}));
  const auto any = open_camera({{"driver", "aravis"}});
  ASSERT_FALSE(any);
  EXPECT_NE(any.error().text().find("say which with 'id': Aravis-Fake-"), std::string::npos)
      << any.error().text();
}

TEST_F(Gige, ControlsAreReadBackAndLimited) {
  const test::GigeCamera device(first_address, "CONTROLS");
  const auto camera = opened({{"exposure_us", "2000"}, {"gain_db", "3"}, {"frame_rate", "20"}});
  ASSERT_TRUE(camera);
  auto controls = camera->controls();
  EXPECT_EQ(controls["exposure_us"].value, "2000");
  EXPECT_EQ(controls["gain_db"].value, "3");
  EXPECT_EQ(controls["frame_rate"].value, "20");
  EXPECT_EQ(controls["trigger"].value, "off");
  EXPECT_DOUBLE_EQ(camera->frame_rate(), 20);
  const auto refused = camera->set_control("exposure_us", "1");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text().find("must be from 10 to"), std::string::npos) << refused.error().text();
  EXPECT_FALSE(camera->set_control("exposure_us", "bright"));
  EXPECT_FALSE(camera->set_control("focus", "1"));
  ASSERT_TRUE(camera->set_control("exposure_us", "7000"));
  ASSERT_TRUE(camera->set_control("frame_rate", "10"));
  for (int i = 0; i < 100 && camera->frame_rate() != 10; ++i) next_frame(*camera);
  EXPECT_EQ(camera->controls()["exposure_us"].value, "7000");
  EXPECT_EQ(camera->controls()["frame_rate"].value, "10");
  EXPECT_EQ(camera->controls()["exposure_us"].problem, "");
}

TEST_F(Gige, SoftwareTrigger) {
  const test::GigeCamera device(first_address, "TRIGGER");
  const auto camera = opened({{"trigger", "software"}});
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->frame_rate(), 0);
  // Nothing comes, and nobody takes the camera for dead.
  for (int i = 0; i < 3; ++i) EXPECT_EQ(camera->next(milliseconds(300)).event, CameraEvent::timeout);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(camera->trigger());
    EXPECT_TRUE(next_frame(*camera));
    EXPECT_EQ(camera->next(milliseconds(200)).event, CameraEvent::timeout);
  }
  EXPECT_EQ(camera->counters().frames, 3u);
}

TEST_F(Gige, TimesAreUtcAndTheMiddleOfTheExposure) {
  const test::GigeCamera device(first_address, "TIME");
  const auto camera = opened({{"frame_rate", "20"}, {"exposure_us", "20000"}});
  ASSERT_TRUE(camera);
  std::int64_t last = 0;
  for (int i = 0; i < 20; ++i) {
    const auto frame = next_frame(*camera);
    ASSERT_TRUE(frame);
    const std::int64_t now = std::chrono::duration_cast<std::chrono::nanoseconds>(
                                 std::chrono::system_clock::now().time_since_epoch())
                                 .count();
    EXPECT_GT(frame->time, last);
    EXPECT_LT(frame->time, now);
    EXPECT_GT(frame->time, now - 1'000'000'000);
    EXPECT_GT(frame->time_sigma, 0);
    last = frame->time;
  }
}

TEST_F(Gige, StopsAndStartsAgain) {
  const test::GigeCamera device(first_address, "AGAIN");
  const auto camera = opened({{"frame_rate", "20"}});
  ASSERT_TRUE(camera);
  ASSERT_TRUE(next_frame(*camera));
  camera->stop();
  ASSERT_TRUE(camera->start());
  ASSERT_TRUE(next_frame(*camera));
  std::thread other([&] {
    std::this_thread::sleep_for(milliseconds(100));
    camera->interrupt();
  });
  while (camera->next(milliseconds(5000)).event == CameraEvent::frame) {
  }
  EXPECT_EQ(camera->next(milliseconds(5000)).event, CameraEvent::stopped);
  other.join();
}

TEST_F(Gige, ErrorsSayWhatToDo) {
  const auto error_of = [](SourceOptions source) {
    source["driver"] = "aravis";
    const auto camera = open_camera(source);
    return camera ? "" : camera.error().text();
  };
  EXPECT_NE(error_of({}).find("no camera answers; is it powered"), std::string::npos);
  const test::GigeCamera device(first_address, "ONLY");
  EXPECT_NE(error_of({{"id", "Manta-7"}}).find("there are Aravis-Fake-ONLY"), std::string::npos);
  EXPECT_NE(error_of({{"format", "Mono12p"}}).find("the camera has no format 'Mono12p'; it has "),
            std::string::npos);
  EXPECT_NE(error_of({{"width", "9000"}}).find("Width: cannot be 9000: from"), std::string::npos);
  const std::string exposure = error_of({{"exposure_us", "1"}});
  EXPECT_NE(exposure.find("must be from 10 to 1e+07"), std::string::npos) << exposure;
  EXPECT_NE(error_of({{"ptp", "true"}}).find("the camera has no PTP"), std::string::npos);
  EXPECT_NE(error_of({{"features", "Nonsense=3"}}).find("features: "), std::string::npos);
  const auto owner = opened({});
  ASSERT_TRUE(owner);
  EXPECT_NE(error_of({}).find("another program controls the camera; stop it first"), std::string::npos);
}

}  // namespace
}  // namespace ca2
