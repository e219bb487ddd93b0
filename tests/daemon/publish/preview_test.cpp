/// @file Small pictures of what sensors see.
#include "daemon/publish/preview.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/io/jpeg.h"

namespace ca2 {
namespace {

CameraObservation noisy(int width, int height) {
  auto image = std::make_shared<Image>(Image{width, height, 1, 8, {}});
  unsigned state = 1;
  for (int i = 0; i < width * height; ++i) {
    state = state * 1664525 + 1013904223;
    image->bytes.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  CameraObservation observation;
  observation.image = image;
  observation.time = 5;
  return observation;
}

TEST(Preview, FitsItsMessageWhateverThePicture) {
  for (const auto& [width, height] : {std::pair(1388, 1038), std::pair(640, 480), std::pair(4096, 3000)}) {
    const Result<Preview> preview = preview_of(noisy(width, height), 640);
    ASSERT_TRUE(preview) << preview.error().text();
    EXPECT_LE(preview->width, 640);
    EXPECT_GE(preview->width, 200);
    EXPECT_LE(preview->jpeg.size(), max_preview_bytes);
    const Result<Image> image = decode_jpeg(preview->jpeg, "preview");
    ASSERT_TRUE(image);
    EXPECT_EQ(image->width, preview->width);
    EXPECT_FALSE(preview->sees_board);
  }
}

TEST(Preview, CornersAreMarkedWhereTheyAre) {
  auto image = std::make_shared<Image>(Image{640, 480, 1, 8, std::vector<std::uint8_t>(640 * 480, 100)});
  CameraObservation observation;
  observation.image = image;
  observation.corners.push_back({0, Eigen::Vector2d(320.5, 240.5)});
  const Result<Preview> preview = preview_of(observation, 320);
  ASSERT_TRUE(preview);
  EXPECT_TRUE(preview->sees_board);
  const Image drawn = decode_jpeg(preview->jpeg, "preview").value();
  ASSERT_EQ(drawn.width, 320);
  const auto green = [&](int x, int y) {
    const std::size_t i = 3 * (static_cast<std::size_t>(y) * 320 + x);
    // JPEG blurs colours over two pixels.
    return drawn.bytes[i + 1] > drawn.bytes[i] + 30;
  };
  EXPECT_TRUE(green(160, 120));
  EXPECT_FALSE(green(100, 120));
}

/// A wall 5 m away with a board before it.
TEST(Preview, TheBoardIsColouredInTheRangeImage) {
  auto scan = std::make_shared<Scan>();
  scan->rings = 16;
  scan->columns = 360;
  LidarObservation observation;
  LidarSight sight;
  sight.plane.normal = Eigen::Vector3d(-1, 0, 0);
  sight.plane.offset = 2;
  sight.center = Eigen::Vector3d(2, 0, 0);
  for (int ring = 0; ring < 16; ++ring) {
    const double elevation = (ring - 8) * 0.03;
    for (int column = 0; column < 360; ++column) {
      // Column 0 looks backwards, columns rise clockwise.
      const double azimuth = M_PI - (column + 0.5) * 2 * M_PI / 360;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const bool board = std::abs(azimuth) < 0.1 && std::abs(elevation) < 0.1;
      const Eigen::Vector3d point = board ? Eigen::Vector3d(ray * 2 / ray.x()) : Eigen::Vector3d(ray * 5);
      scan->points.push_back(point.cast<float>());
      scan->ring.push_back(static_cast<std::uint16_t>(ring));
      scan->column.push_back(static_cast<std::uint32_t>(column));
      if (board) sight.on_board.push_back({point.cast<float>()});
    }
  }
  observation.scan = scan;
  observation.sights.push_back(sight);
  const Result<Preview> preview = preview_of(observation, 360);
  ASSERT_TRUE(preview) << preview.error().text();
  EXPECT_TRUE(preview->sees_board);
  const Image drawn = decode_jpeg(preview->jpeg, "preview").value();
  int coloured = 0;
  for (std::size_t i = 0; i < drawn.bytes.size(); i += 3) {
    coloured += drawn.bytes[i] > drawn.bytes[i + 2] + 100 ? 1 : 0;
  }
  const int thick = drawn.height / 16;
  EXPECT_NEAR(coloured, static_cast<double>(sight.on_board.size()) * thick, 0.4 * coloured);
}

TEST(Preview, NothingYetIsSaid) {
  EXPECT_EQ(preview_of(CameraObservation(), 320).error().code, ErrorCode::unavailable);
  EXPECT_EQ(preview_of(LidarObservation(), 320).error().code, ErrorCode::unavailable);
}

}  // namespace
}  // namespace ca2
