/// @file Sessions made of LCM logs, which liblcm and the code of lcm-gen write, and of Kalibr's files.
#include <cstring>
#include <lcm/lcm-cpp.hpp>

#include "bot_core/image_t.hpp"
#include "bot_core/pointcloud2_t.hpp"
#include "bot_core/pointcloud_t.hpp"
#include "core/io/files.h"
#include "core/session/session.h"
#include "pronto/pointcloud_t.hpp"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

constexpr std::int64_t start = 1'700'000'000'000'000;  // us

class LogWriter {
 public:
  explicit LogWriter(const fs::path& file) : log_(file, "w") {}

  template <class Message>
  void write(const std::string& channel, const Message& message) {
    write(channel, message, message.utime + 7000);
  }
  template <class Message>
  void write(const std::string& channel, const Message& message, std::int64_t logged) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    ASSERT_GE(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    lcm::LogEvent event;
    event.eventnum = count_++;
    event.timestamp = logged;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.data = bytes.data();
    ASSERT_EQ(log_.writeEvent(&event), 0);
  }

 private:
  lcm::LogFile log_;
  std::int64_t count_ = 0;
};

bot_core::image_t picture_message(const Image& image, std::int64_t utime, int padding) {
  bot_core::image_t message;
  message.utime = utime;
  message.width = image.width;
  message.height = image.height;
  message.row_stride = image.width + padding;
  message.pixelformat = 1497715271;  // grey
  for (int y = 0; y < image.height; ++y) {
    const auto row = image.bytes.begin() + y * image.width;
    message.data.insert(message.data.end(), row, row + image.width);
    message.data.insert(message.data.end(), static_cast<std::size_t>(padding), 0xaa);
  }
  message.size = static_cast<std::int32_t>(message.data.size());
  bot_core::image_metadata_t note;
  note.key = "note";
  note.n = 0;
  message.nmetadata = 1;
  message.metadata = {note};
  return message;
}

template <class Message>
Message cloud_message(const Scan& scan, std::int64_t utime, bool by_point) {
  Message message;
  message.utime = utime;
  message.frame_id = "puck";
  message.n_points = static_cast<std::int32_t>(scan.size());
  for (const Eigen::Vector3f& p : scan.points) message.points.push_back({p.x(), p.y(), p.z()});
  message.n_channels = 2;
  message.channel_names = {"intensity", "ring"};
  const std::vector<float> ring(scan.ring.begin(), scan.ring.end());
  if (by_point) {
    for (std::size_t i = 0; i < scan.size(); ++i) message.channels.push_back({scan.intensity[i], ring[i]});
  } else {
    message.channels = {scan.intensity, ring};
  }
  return message;
}

/// As ROS packs a Velodyne's points: x y z intensity as floats, ring as uint16, padded to 24 bytes.
bot_core::pointcloud2_t cloud2_message(const Scan& scan, std::int64_t utime) {
  bot_core::pointcloud2_t message{};
  message.utime = utime;
  message.height = 1;
  message.width = static_cast<std::int32_t>(scan.size());
  const auto field = [&](const char* name, int offset, int type) {
    bot_core::pointfield_t f;
    f.name = name;
    f.offset = offset;
    f.datatype = static_cast<std::int8_t>(type);
    f.count = 1;
    message.fields.push_back(f);
  };
  field("x", 0, 7), field("y", 4, 7), field("z", 8, 7), field("intensity", 16, 7), field("ring", 20, 4);
  message.nfields = 5;
  message.point_step = 24;
  message.row_step = 24 * message.width;
  message.data_nbytes = message.row_step;
  message.data.resize(static_cast<std::size_t>(message.data_nbytes));
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::uint8_t* at = message.data.data() + 24 * i;
    std::memcpy(at, scan.points[i].data(), 12);
    std::memcpy(at + 16, &scan.intensity[i], 4);
    std::memcpy(at + 20, &scan.ring[i], 2);
  }
  message.is_dense = true;
  return message;
}

class ImportLog : public SmallSession {
 protected:
  /// Every view as the three kinds of clouds in turn; the LiDAR's clock is 5 ms late, and pictures come three
  /// times as often.
  void record(int views) const {
    LogWriter log(folder / "log.lcm");
    for (int view = 1; view <= views; ++view) {
      const auto image = read_png(picture(view));
      const auto scan = read_pcd(cloud(view));
      ASSERT_TRUE(image && scan);
      const std::int64_t t = start + view * 1'000'000;
      for (const std::int64_t off : {-300'000, 0, 300'000})
        log.write("FRONT", picture_message(off == 0 ? *image : *read_png(picture(8)), t + off, view % 2 * 6));
      if (view % 3 == 0) log.write("VELODYNE", cloud_message<bot_core::pointcloud_t>(*scan, t + 5000, false));
      if (view % 3 == 1) log.write("VELODYNE", cloud2_message(*scan, t + 5000));
      if (view % 3 == 2) log.write("VELODYNE", cloud_message<pronto::pointcloud_t>(*scan, t + 5000, true));
    }
    bot_core::pointfield_t other{};
    other.name = "no measurement";
    struct Timed : bot_core::pointfield_t {
      std::int64_t utime = start;
    } timed;
    log.write("POSE", timed);
  }

  Outcome run(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{"import",   folder / "log.lcm", "--rig", session / "session.yaml",
                                   "--output", folder / "made"};
    words.insert(words.end(), options.begin(), options.end());
    return run_ca2(words);
  }
};

TEST_F(ImportLog, EveryTypeGivesThePicturesAndPointsThatWereLogged) {
  record(3);
  const Outcome imported = run();
  ASSERT_EQ(imported.status, 0) << imported.errors;
  EXPECT_EQ(imported.errors, "");
  EXPECT_NE(imported.output.find("3 views paired by time"), std::string::npos) << imported.output;
  for (int view = 1; view <= 3; ++view) {
    const fs::path made = folder / "made/views" / ("00000" + std::to_string(view));
    const auto was = read_pcd(cloud(view)), is = read_pcd(made / "puck.pcd");
    const auto before = read_png(picture(view)), after = read_png(made / "front.png");
    ASSERT_TRUE(was && is && before && after);
    EXPECT_EQ(was->points, is->points) << view;
    EXPECT_EQ(was->intensity, is->intensity) << view;
    EXPECT_EQ(was->ring, is->ring) << view;
    EXPECT_EQ(before->bytes, after->bytes) << view;
  }
}

TEST_F(ImportLog, WhatCannotBeReadIsNamed) {
  write_bytes(folder / "log.lcm", "no log at all");
  Outcome outcome = run();
  EXPECT_EQ(outcome.status, 65);
  EXPECT_NE(outcome.errors.find("is no LCM log"), std::string::npos) << outcome.errors;
  record(2);
  outcome = run({"--channel", "front=POSE"});
  EXPECT_EQ(outcome.status, 65);
  EXPECT_NE(outcome.errors.find("POSE (1 of a type that is not read)"), std::string::npos) << outcome.errors;
  EXPECT_NE(run({"--channel", "rear=FRONT"}).errors.find("no sensor of this name"), std::string::npos);
  EXPECT_EQ(run({"--channel", "front"}).status, 64);
  EXPECT_FALSE(fs::exists(folder / "made"));
  outcome = run({"--tolerance", "0.004"});
  EXPECT_NE(outcome.errors.find("further apart than --tolerance"), std::string::npos) << outcome.errors;
  EXPECT_EQ(run({"--channel", "puck=VELODYNE", "--channel", "front=FRONT"}).status, 0);
}

/// A stamp that no ns of 64 bits can tell counts as none, as 0 does.
TEST_F(ImportLog, ImpossibleTimesAreThoseOfLogging) {
  const auto image = read_png(picture(1));
  const auto scan = read_pcd(cloud(1));
  ASSERT_TRUE(image && scan);
  {
    LogWriter log(folder / "log.lcm");
    constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
    log.write("FRONT", picture_message(*image, never, 0), start);
    log.write("VELODYNE", cloud2_message(*scan, start + 5000));
    log.write("FRONT", picture_message(*image, never, 0), never);
  }
  const Outcome imported = run();
  ASSERT_EQ(imported.status, 0) << imported.errors;
  EXPECT_NE(imported.output.find("1 view paired by time"), std::string::npos) << imported.output;
}

/// liblcm would take 2 GiB, or write to where it got none.
TEST_F(ImportLog, LengthsBeyondTheFileAreDamage) {
  record(2);
  std::string damaged = bytes_of(folder / "log.lcm");
  const std::size_t second = damaged.find("\xED\xA1\xDA\x01", 1);
  for (const char* length : {"\x7f\xff\xff\xff", "\x7f\xff\xff\xfe"}) {
    write_bytes(folder / "log.lcm", damaged.replace(24, 4, length));
    EXPECT_EQ(run().status, 65) << "the first event";
  }
  damaged = bytes_of(folder / "log.lcm").substr(second);
  damaged.replace(damaged.find("\xED\xA1\xDA\x01", damaged.size() / 2) + 24, 4, "\x7f\xff\xff\xff");
  write_bytes(folder / "log.lcm", damaged);
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NE(outcome.output.find("1 view paired by time"), std::string::npos) << outcome.output;
}

/// Every cut and many damaged bytes: a view less, or an error, never a crash or a wait.
TEST_F(ImportLog, DamageCostsViewsOnly) {
  record(2);
  const std::string whole = bytes_of(folder / "log.lcm");
  for (int k = 1; k <= 12; ++k) {
    std::string damaged = whole;
    if (k % 2) {
      damaged.resize(whole.size() * static_cast<std::size_t>(k) / 13);
    } else {
      for (std::size_t at = static_cast<std::size_t>(k) * 977; at < damaged.size(); at += damaged.size() / 40)
        damaged[at] = static_cast<char>(damaged[at] ^ 0xff);
      for (std::size_t at = 28 + 5; at < 28 + 60; at += static_cast<std::size_t>(k)) damaged[at] = '\xff';
    }
    write_bytes(folder / "log.lcm", damaged);
    fs::remove_all(folder / "made");
    const Outcome outcome = run();
    EXPECT_TRUE(outcome.status == 0 || outcome.status == 65) << k << ": " << outcome.status << outcome.errors;
  }
}

TEST_F(ImportLog, KalibrsFilesMakeTheRig) {
  write_bytes(folder / "target.yaml",
              "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088  #m\ntagSpacing: 0.3\n");
  write_bytes(
      folder / "camchain.yaml",
      "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [-0.1, 0.02, 0.001, "
      "-0.002]\n"
      "  distortion_model: radtan\n  intrinsics: [460.5, 461.5, 320.5, 240.5]\n  resolution: [640, 480]\n"
      "  rostopic: /cam0/image_raw\n"
      "cam1:\n  T_cn_cnm1:\n  - [0.0, -1.0, 0.0, -0.11]\n  - [1.0, 0.0, 0.0, 0.02]\n  - [0.0, 0.0, 1.0, "
      "0.03]\n"
      "  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [0]\n  camera_model: pinhole\n"
      "  distortion_coeffs: [0.01, 0.02, 0.003, 0.004]\n  distortion_model: equidistant\n"
      "  intrinsics: [450.0, 451.0, 319.0, 239.0]\n  resolution: [640, 480]\n  rostopic: /cam1/image_raw\n");
  for (const char* sensor : {"cam0", "cam1"}) {
    fs::create_directories(folder / "data" / sensor);
    fs::copy_file(picture(1), folder / "data" / sensor / "1403636579763555584.png");
  }
  fs::create_directories(folder / "data/top");
  fs::copy_file(cloud(1), folder / "data/top/1403636579773555584.pcd");
  const auto import = [&] {
    fs::remove_all(folder / "made");
    return run_ca2({"import", folder / "data", "--target", folder / "target.yaml", "--camchain",
                    folder / "camchain.yaml", "--lidar", "top", "--output", folder / "made"});
  };
  const Outcome imported = import();
  ASSERT_EQ(imported.status, 0) << imported.errors;
  const auto made = open_session(folder / "made");
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_EQ(made->views.size(), 1u);
  EXPECT_EQ(made->rig.board.type->name(), "aprilgrid");
  EXPECT_EQ(made->rig.board.columns, 6);
  EXPECT_EQ(made->rig.board.rows, 5);
  EXPECT_DOUBLE_EQ(made->rig.board.square, 0.088);
  EXPECT_DOUBLE_EQ(made->rig.board.spacing, 0.3);
  EXPECT_EQ(made->rig.cameras.at("cam1").intrinsics->model->name(), "kannala_brandt");
  ASSERT_EQ(made->rig.extrinsics.size(), 1u);
  const RigExtrinsic& link = made->rig.extrinsics[0];
  EXPECT_EQ(link.parent + " " + link.child, "cam1 cam0");
  EXPECT_FALSE(link.fixed);
  // A point of cam0 in cam1, by hand.
  EXPECT_LT((link.T_parent_child * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(-2.11, 1.02, 3.03)).norm(),
            1e-12);

  const std::pair<const char*, const char*> wrong[] = {
      {"target_type: 'circlegrid'\ntargetCols: 6\n", "a 'circlegrid' is not read"},
      {"target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\ncolSpacingMeters: "
       "0.05\n",
       "differs from colSpacingMeters"},
      {"target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\ncodeOffset: 10\n",
       "do not begin with id 0"},
      {"tagCols: 6\n", "target_type"},
      {"[1, 2]\n", "no target"}};
  for (const auto& [text, message] : wrong) {
    write_bytes(folder / "target.yaml", text);
    const Outcome outcome = import();
    EXPECT_EQ(outcome.status, 78) << text;
    EXPECT_NE(outcome.errors.find(message), std::string::npos) << outcome.errors;
  }
}

}  // namespace
}  // namespace ca2
