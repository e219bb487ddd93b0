#include <gtest/gtest.h>

#include "tests/support/board_renderer.h"
#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

Board aprilgrid(int columns, int rows) {
  Board board = test::make_board("aprilgrid", columns, rows, 0.05);
  board.spacing = 0.3;
  return board;
}

/// Views through both lenses, whole, tilted and cut by the picture's rim: every id in its place, and corners
/// as good as a chessboard's, since they are crossings too.
TEST(Aprilgrid, IsRefinedWholeAndInPart) {
  const Board board = aprilgrid(6, 5);
  struct View {
    Camera camera;
    Eigen::Vector3d bearing;
    double distance, tilt, roll;
    std::size_t least;  ///< corners, of 120
  };
  const View views[] = {{test::narrow_camera(), {0, 0.1, 1}, 0.9, 0.2, 0.5, 115},
                        {test::narrow_camera(), {0, 0.1, 1}, 1.2, 0.9, 0.5, 115},
                        {test::narrow_camera(), {0.5, 0.1, 1}, 0.9, 0.2, 0.5, 40},
                        {test::narrow_camera(), {0, 0, 1}, 1.0, 0.3, 2.5, 115},
                        {test::fisheye_camera(), {0, 0.1, 1}, 0.3, 0.2, 0.5, 105}};
  std::mt19937_64 random(7);
  for (const View& view : views) {
    const Pose truth = test::board_pose(view.bearing, view.distance, view.tilt, 1.2, view.roll);
    const auto pixels = test::true_corners(board, view.camera, truth);
    const auto corners = detect_board(board, test::render_board(board, view.camera, truth, {}, random));
    EXPECT_GE(corners.size(), view.least);
    double sum = 0;
    for (const Corner& corner : corners) {
      const auto& pixel = pixels[static_cast<std::size_t>(corner.id)];
      ASSERT_TRUE(pixel);
      EXPECT_LT((corner.pixel - *pixel).norm(), 0.25) << corner.id;
      sum += (corner.pixel - *pixel).squaredNorm();
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(corners.size())), 0.05);
    const auto pose = estimate_board_pose(board, view.camera, corners);
    ASSERT_TRUE(pose) << pose.error().text();
    EXPECT_LT(truth.difference(pose->T_camera_board).norm(), 0.01);
  }
}

TEST(Aprilgrid, IsNotFoundWhereItIsNot) {
  std::mt19937_64 random(3);
  const Camera camera = test::narrow_camera();
  const Pose pose = test::board_pose({0, 0, 1}, 1, 0.2, 1, 0);
  const Image other = test::render_board(test::make_board("checkerboard", 8, 6), camera, pose, {}, random);
  EXPECT_TRUE(detect_board(aprilgrid(6, 6), other).empty());
  EXPECT_TRUE(
      aprilgrid(6, 6).type->find(aprilgrid(6, 6), Image{8, 8, 1, 8, std::vector<std::uint8_t>(64)}).empty());
  EXPECT_TRUE(aprilgrid(6, 6).type->find(aprilgrid(6, 6), Image{}).empty());
}

}  // namespace
}  // namespace ca2
