/// @file What tracks keep of the data: a second of a rig's pictures is a hundred megabytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/capture/assess.h"

namespace ca2 {
namespace {

constexpr std::int64_t start = 1'700'000'000'000'000'000;  // ns UTC

Board a_board() {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = 8;
  board.rows = 6;
  board.square = 0.04;
  return board;
}

CameraObservation picture(const Board& board, std::int64_t time, double at) {
  CameraObservation observation;
  observation.time = time;
  observation.image = std::make_shared<const Image>(Image{1, 1, 1, 8, {0}});
  int id = 0;
  for (const Eigen::Vector2d& place : board.type->corners(board)) {
    observation.corners.push_back(
        {id++, 1000 * place + Eigen::Vector2d(at, 100), Eigen::Matrix2d::Identity()});
  }
  return observation;
}

int with_image(const CameraTrack& track) {
  int count = 0;
  for (const CameraObservation* kept : track.between(start, start + 10'000'000'000)) {
    count += kept->image != nullptr;
  }
  return count;
}

TEST(Tracks, KeepSixteenPicturesASecondAndTheNewest) {
  const Board board = a_board();
  for (const double rate : {10.0, 15.0, 30.0, 90.0}) {
    CameraTrack track(board);
    for (int i = 0; i <= rate; ++i) {
      track.add(picture(board, start + std::llround(1e9 * i / rate), 100));
      EXPECT_TRUE(track.newest()->image);
    }
    EXPECT_NEAR(with_image(track), std::min(rate + 1, 17.0), 1) << rate << " Hz";
  }
}

TEST(Tracks, LetGoOfWhatIsInNoViewAnyMore) {
  const Board board = a_board();
  const CaptureOptions options;
  Tracks tracks;
  tracks.camera_names = {"camera"};
  tracks.cameras.emplace_back(board);
  CameraTrack& track = tracks.cameras[0];
  const auto show = [&](int i, double at) {
    const std::int64_t time = start + i * 100'000'000LL;
    track.add(picture(board, time, at));
    const Assessment assessment = assess(tracks, options, time);
    release_unneeded(tracks, options, assessment, std::nullopt);
    return assessment;
  };
  for (int i = 0; i < 15; ++i) show(i, 100 + 20 * i);
  EXPECT_LE(with_image(track), 4) << "while it moves";
  Assessment assessment;
  for (int i = 15; i < 25; ++i) assessment = show(i, 400);
  ASSERT_EQ(assessment.phase, Assessment::Phase::ready);
  for (const CameraObservation* held : track.between(assessment.since, assessment.newest)) {
    EXPECT_TRUE(held->image) << "of the hold";
  }
  EXPECT_EQ(with_image(track), static_cast<int>(track.between(assessment.since, assessment.newest).size()))
      << "and no more";
  const std::int64_t asked = track.newest()->time - 500'000'000;
  release_unneeded(tracks, options, assessment, asked);
  EXPECT_EQ(with_image(track), 6) << "since somebody asked for another view";
  release_unneeded(tracks, options, assessment, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(with_image(track), 2) << "once it is decided: for who wants a view at once";
}

TEST(Tracks, LetGoOfScansThatBeganBeforeAnyViewCan) {
  LidarTrack track;
  const auto at = [](int i) { return start + i * 100'000'000LL; };
  for (int i = 0; i < 20; ++i) {
    LidarObservation observation;
    observation.time = at(i);
    observation.scan = std::make_shared<const Scan>();
    observation.sights.emplace_back();
    track.add(observation);
  }
  const auto with_scan = [&](const std::vector<const LidarObservation*>& list) {
    return std::count_if(list.begin(), list.end(), [](const auto* kept) { return kept->scan != nullptr; });
  };
  const auto all = [&] { return track.within(start - 1'000'000'000, at(100)); };
  for (const std::int64_t first : {at(10) - 70'000'000, at(10) - 50'000'000, at(10), at(11) - 40'000'000}) {
    track.release_before(first);
    const auto view = track.within(first, at(100));
    EXPECT_EQ(with_scan(view), static_cast<std::ptrdiff_t>(view.size())) << first - at(10);
    EXPECT_EQ(with_scan(all()), with_scan(view)) << first - at(10) << " ns: more than a view takes";
  }
  track.release_before(at(100));
  EXPECT_EQ(with_scan(all()), 1) << "the newest";
}

TEST(Tracks, KeepAHoldThatGoesOnWithinTheBudget) {
  const Board board = a_board();
  const CaptureOptions options;
  Tracks tracks;
  for (const char* name : {"left", "right"}) {
    tracks.camera_names.push_back(name);
    tracks.cameras.emplace_back(board);
  }
  tracks.lidar_names = {"top"};
  tracks.lidars.emplace_back();
  Scan scan;
  scan.points.resize(1'000'000 / sizeof scan.points[0]);
  const auto megabyte = std::make_shared<const Scan>(scan);
  const auto picture_megabyte =
      std::make_shared<const Image>(Image{1000, 1000, 1, 8, std::vector<std::uint8_t>(1'000'000)});
  const auto kept = [&] {
    std::size_t bytes = tracks.lidars[0].kept().bytes();
    for (CameraTrack& camera : tracks.cameras) bytes += camera.kept().bytes();
    return 1e-6 * static_cast<double>(bytes);
  };
  const auto hold = [&](int from, int to, std::size_t budget) {
    for (int i = from; i < to; ++i) {
      const std::int64_t time = start + i * 100'000'000LL;
      for (CameraTrack& camera : tracks.cameras) {
        CameraObservation seen = picture(board, time, 400);
        seen.image = picture_megabyte;
        camera.add(seen);
      }
      LidarObservation observation;
      observation.time = time;
      observation.scan = megabyte;
      observation.sights.emplace_back();
      tracks.lidars[0].add(observation);
      release_unneeded(tracks, options, assess(tracks, options, time), std::nullopt, budget);
    }
  };
  hold(0, 15, 100'000'000);
  EXPECT_NEAR(kept(), 45, 1) << "there is room for all";
  EXPECT_EQ(tracks.cameras[0].let_go() + tracks.lidars[0].let_go(), 0u);
  hold(15, 20, 40'000'000);
  EXPECT_NEAR(kept(), 40, 1.01);
  const std::int64_t oldest = tracks.cameras[0].kept().oldest()->time;
  EXPECT_NEAR(1e-9 * static_cast<double>(tracks.lidars[0].kept().oldest()->time - oldest), 0, 0.11)
      << "all reach equally far back";
  const std::uint64_t gone = tracks.cameras[0].let_go();
  EXPECT_NEAR(static_cast<double>(gone), 60.0 / 3 - 40.0 / 3, 1.01);
  hold(20, 22, 1'000'000);
  EXPECT_NEAR(kept(), 3 * 8, 1) << "a dwell is kept whatever the budget";
  EXPECT_GT(tracks.cameras[0].let_go(), gone);
}

}  // namespace
}  // namespace ca2
