/// A simulated recording, true packets and pictures, through the readers, the detectors, the pipeline and the
/// solve.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "core/features/extract.h"
#include "core/io/files.h"
#include "core/solve/calibrate.h"
#include "drivers/recording/replay.h"
#include "tests/support/temporary_directory.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/recording_writer.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// A VLP-16 over a small camera, and a large board: quick to render.
constexpr const char* scenario_text = R"(version: 1
seed: 5
board: {type: checkerboard, columns: 6, rows: 4, square: 0.1, outline: {width: 0.8, height: 0.6}}
cameras:
  front:
    frame: front_optical
    image_size: [400, 300]
    intrinsics: {model: pinhole_radtan, parameters: [300, 301, 200.3, 149.1, -0.05, 0.02, 0, 0]}
lidars:
  top: {frame: top, model: VLP-16}
truth:
  extrinsics:
    - {parent: front, child: top, translation: [0.02, -0.15, -0.05], rotation: {x: 0.70710678118, y: 0, z: 0, w: 0.70710678118}}
views: {count: 5, distance: [1.6, 2.6], tilt: [0.2, 0.8], min_rings: 4}
scene: {size: [8, 7, 3], furniture: 4, second_person: true}
noise:
  lidars: {range_sigma: 0.008}
recording: {hold: [0.8, 0.9], move: [0.7, 0.9], camera_rate: 12, lost_pictures: 0.03, clock_offset: 0.004}
)";

class Recordings : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new test::TemporaryDirectory;
    const fs::path file = directory_->path() / "scenario.yaml";
    ASSERT_TRUE(write_atomically(file, scenario_text));
    auto scenario = read_scenario(file);
    ASSERT_TRUE(scenario) << scenario.error().text();
    scenario_ = new ScenarioFile(*scenario);
    const auto written = write_simulated_recording(*scenario_, directory_->path() / "recording");
    ASSERT_TRUE(written) << written.error().text();
  }
  static void TearDownTestSuite() {
    delete scenario_;
    delete directory_;
  }

  static fs::path path(const std::string& name) { return directory_->path() / name; }

  static Session replayed(const std::string& name, int threads) {
    const Recording recording = open_recording(path("recording")).value();
    auto reader = RecordingReader::open(recording);
    Session session = session_of(recording, path(name)).value();
    ReplayOptions options;
    options.threads = threads;
    const auto report = replay(recording.rig, *reader, session, options);
    EXPECT_TRUE(report) << (report ? "" : report.error().text());
    EXPECT_TRUE(reader->warnings().empty());
    return session;
  }

  static test::TemporaryDirectory* directory_;
  static ScenarioFile* scenario_;
};

test::TemporaryDirectory* Recordings::directory_ = nullptr;
ScenarioFile* Recordings::scenario_ = nullptr;

std::map<std::string, std::string> content(const fs::path& directory) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), directory)] = read_text(entry.path()).value();
  }
  return files;
}

TEST_F(Recordings, EverySensorIsThereOnOneClock) {
  const Recording recording = open_recording(path("recording")).value();
  EXPECT_EQ(recording.start, simulated_start);
  auto reader = RecordingReader::open(recording);
  ASSERT_TRUE(reader);
  std::int64_t last = 0;
  int pictures = 0, scans = 0;
  while (const auto frame = reader->next()) {
    EXPECT_GE(frame->arrival, last);
    last = frame->arrival;
    if (frame->image) {
      ++pictures;
      EXPECT_EQ(frame->image->width, 400);
      continue;
    }
    ++scans;
    EXPECT_NEAR(1e-9 * static_cast<double>(frame->arrival - frame->time), 0.05, 0.06);
    EXPECT_GT(frame->scan->returns(), 5000u);
  }
  EXPECT_EQ(pictures, reader->pictures());
  const double seconds = 1e-9 * static_cast<double>(last - recording.start);
  EXPECT_NEAR(pictures, 0.97 * 12 * seconds, 0.1 * 12 * seconds);
  EXPECT_NEAR(scans, 10 * seconds, 3);
}

TEST_F(Recordings, AScanShowsTheBoardWhereItIs) {
  const auto holds = read_true_holds(path("recording/truth.yaml"));
  ASSERT_TRUE(holds) << holds.error().text();
  ASSERT_EQ(holds->size(), 5u);
  const Recording recording = open_recording(path("recording")).value();
  auto reader = RecordingReader::open(recording);
  int checked = 0;
  while (const auto frame = reader->next()) {
    if (!frame->scan) continue;
    for (const RecordedHold& hold : *holds) {
      if (frame->time - 50'000'000 < hold.from || frame->time + 50'000'000 > hold.to) continue;
      // Returns within the plate's outline lie in its plane: noise, tremor and the wire's rounding.
      const Pose T_board_lidar = hold.T_sensor_board.at("top").inverse();
      int on_plate = 0;
      for (const Eigen::Vector3f& point : frame->scan->points) {
        const Eigen::Vector3d p = T_board_lidar * point.cast<double>();
        if (std::abs(p.x()) > 0.3 || std::abs(p.y()) > 0.2 || std::abs(p.z()) > 0.3) continue;
        on_plate += std::abs(p.z()) < 0.04;
      }
      EXPECT_GT(on_plate, 40) << "hold " << hold.id;
      ++checked;
    }
  }
  EXPECT_GT(checked, 25);
}

TEST_F(Recordings, ReplayCapturesEveryHoldAndSolves) {
  const Session session = replayed("session", 2);
  EXPECT_EQ(session.views.size(), 5u);
  const auto features = extract_features(session, {});
  ASSERT_TRUE(features) << features.error().text();
  const auto calibration = calibrate(features->rig, features->views, {});
  ASSERT_TRUE(calibration) << calibration.error().text();
  const TransformError error = worst_error(*calibration, scenario_->scenario);
  EXPECT_LT(error.nees, 22.5);  // chi-squared, 6 degrees of freedom, 0.1 %
  EXPECT_LT(error.translation, 0.03);
  EXPECT_LT(error.rotation, 0.015);
}

TEST_F(Recordings, ReplayIsExactWhateverTheThreads) {
  replayed("one", 1);
  replayed("three", 3);
  const auto one = content(path("one/views")), three = content(path("three/views"));
  ASSERT_FALSE(one.empty());
  EXPECT_EQ(one, three);
}

/// What was searched before it was written, against what the files show.
TEST_F(Recordings, StoredViewsAreWhatTheirFilesShow) {
  const Session session = replayed("stored", 2);
  ASSERT_FALSE(session.views.empty());
  for (const SessionView& view : session.views) {
    ExtractOptions options;
    options.views = {view.id};
    const auto searched = extract_features(session, options);
    ASSERT_TRUE(searched) << searched.error().text();
    EXPECT_EQ(searched->cached, 2);  // the key is right, too
    options.cache = false;
    const auto read = extract_features(session, options);
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(read->cached, 0);
    const ViewSights &a = searched->views.at(0), &b = read->views.at(0);
    ASSERT_TRUE(a.cameras[0] && b.cameras[0]);
    ASSERT_EQ(a.cameras[0]->corners.size(), b.cameras[0]->corners.size());
    for (std::size_t i = 0; i < b.cameras[0]->corners.size(); ++i)
      EXPECT_EQ(a.cameras[0]->corners[i].pixel, b.cameras[0]->corners[i].pixel);
    ASSERT_EQ(a.lidars[0].size(), b.lidars[0].size());
    for (std::size_t i = 0; i < b.lidars[0].size(); ++i) {
      const LidarSight &one = a.lidars[0][i], &other = b.lidars[0][i];
      EXPECT_EQ(one.plane.offset, other.plane.offset);
      EXPECT_EQ(one.around.size(), other.around.size());
      EXPECT_EQ(one.crossings.size(), other.crossings.size());
      ASSERT_EQ(one.on_board.size(), other.on_board.size());
      for (std::size_t k = 0; k < other.on_board.size(); ++k)
        EXPECT_EQ(one.on_board[k].point, other.on_board[k].point);
    }
  }
  // A copy has other times of change: then the contents decide.
  fs::copy(path("stored"), path("copied"), fs::copy_options::recursive);
  const auto copied = extract_features(open_session(path("copied")).value(), {});
  ASSERT_TRUE(copied);
  EXPECT_EQ(copied->searched, 0);
}

TEST_F(Recordings, AnotherReplayAddsNothingNew) {
  replayed("twice", 2);
  EXPECT_EQ(replayed("twice", 2).views.size(), 5u);
}

TEST_F(Recordings, WhatIsMissingOrDamagedIsSaid) {
  fs::copy(path("recording"), path("damaged"), fs::copy_options::recursive);
  fs::resize_file(path("damaged/lidars/top.pcap"), 3'000'001);
  const fs::path picture = fs::directory_iterator(path("damaged/cameras/front"))->path();
  fs::resize_file(picture, 100);
  const Recording recording = open_recording(path("damaged")).value();
  auto reader = RecordingReader::open(recording);
  ASSERT_TRUE(reader) << reader.error().text();
  int scans = 0;
  while (const auto frame = reader->next()) scans += frame->scan != nullptr;
  EXPECT_GT(scans, 5);
  ASSERT_EQ(reader->warnings().size(), 2u);  // the picture, and where the capture ends
  EXPECT_TRUE(std::any_of(reader->warnings().begin(), reader->warnings().end(), [](const Problem& problem) {
    return problem.what.starts_with("ends in the middle of a record");
  }));
  fs::remove_all(path("damaged"));
  EXPECT_FALSE(open_recording(path("nowhere")));
  const auto none = RecordingReader::open(recording);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::data);
  EXPECT_EQ(none.error().problems.size(), 3u);
}

TEST_F(Recordings, PacketsOfAnotherModelThanTheRigSaysAreSaidToBe) {
  Recording recording = open_recording(path("recording")).value();
  recording.rig.lidars.at("top").model = "HDL-32E";
  auto reader = RecordingReader::open(recording);
  ASSERT_TRUE(reader) << reader.error().text();
  while (reader->next()) {
  }
  ASSERT_EQ(reader->warnings().size(), 1u);
  EXPECT_NE(reader->warnings()[0].what.find("no scan of this sensor, HDL-32E, is in it: "), std::string::npos)
      << reader->warnings()[0].what;
  EXPECT_NE(reader->warnings()[0].what.find("model of another sensor"), std::string::npos);
}

}  // namespace
}  // namespace ca2
