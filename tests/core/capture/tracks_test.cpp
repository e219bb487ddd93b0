/// @file What tracks keep of the data: a second of a rig's pictures is a hundred megabytes.
#include <gtest/gtest.h>

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
    release_unneeded(tracks, options, assessment, false);
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
  release_unneeded(tracks, options, assessment, true);
  EXPECT_LE(with_image(track), 10) << "once it is decided";
  EXPECT_GE(with_image(track), 6) << "a dwell, for who asks for another view";
}

}  // namespace
}  // namespace ca2
