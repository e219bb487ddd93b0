/// @file The search in a camera's stream: which pictures are searched.
#include "core/capture/camera_detector.h"

#include <gtest/gtest.h>

#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

constexpr std::int64_t start = 1'700'000'000'000'000'000, second = 1'000'000'000;  // ns

/// Squares of 20 px; `at`: the first one's left.
std::shared_ptr<const Image> picture(const Board& board, int at) {
  Image image{240, 160, 1, 8, std::vector<std::uint8_t>(240 * 160, 200)};
  const Eigen::Vector2d size = board.type->pattern_size(board);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Eigen::Vector2d p = Eigen::Vector2d(x - at + 0.5, y - 30 + 0.5) * (board.square / 20) - size / 2;
      if (board.type->black(board, p)) image.bytes[static_cast<std::size_t>(y * image.width + x)] = 40;
    }
  }
  return std::make_shared<const Image>(std::move(image));
}

TEST(CameraDetector, SparesPicturesWhileTheBoardIsAwayAndNoneWhileItIsThere) {
  const Board board = test::make_board("checkerboard", 4, 3);
  const auto empty =
      std::make_shared<const Image>(Image{240, 160, 1, 8, std::vector<std::uint8_t>(240 * 160)});
  CameraDetector detector(board, 0);
  std::int64_t time = start;
  const auto count_searched = [&](const auto& image, int seconds) {
    int searched = 0;
    for (const std::int64_t end = time + seconds * second; time < end; time += second / 30) {
      const CameraObservation observation = detector.detect(time, image);
      EXPECT_NE(observation.searched, observation.spared);
      EXPECT_EQ(observation.searched, observation.image != nullptr);
      searched += observation.searched ? 1 : 0;
    }
    return searched;
  };
  EXPECT_GE(count_searched(empty, 1), 30);
  EXPECT_NEAR(count_searched(empty, 3), 30, 2);
  // It is seen within a tenth of a second, and then in every picture, wherever it goes.
  int unseen = 0;
  while (detector.detect(time, picture(board, 40)).corners.empty() && ++unseen < 10) time += second / 30;
  EXPECT_LE(unseen, 3);
  for (int at = 40; at < 80; at += 2) {
    time += second / 30;
    EXPECT_FALSE(detector.detect(time, picture(board, at)).corners.empty()) << at;
  }
  // Lost, it is looked for everywhere again; so it is when the clock is set back.
  EXPECT_GE(count_searched(empty, 1), 30);
  EXPECT_NEAR(count_searched(empty, 1), 10, 1);
  time = start;
  EXPECT_TRUE(detector.detect(time, empty).searched);
}

TEST(CameraDetector, SparesNothingOfASlowCamera) {
  const Board board = test::make_board("checkerboard", 4, 3);
  const auto empty =
      std::make_shared<const Image>(Image{240, 160, 1, 8, std::vector<std::uint8_t>(240 * 160)});
  CameraDetector detector(board, 0);
  for (int i = 0; i < 40; ++i) EXPECT_TRUE(detector.detect(start + i * second / 10, empty).searched) << i;
}

}  // namespace
}  // namespace ca2
