#include <gtest/gtest.h>

#include "tests/support/board_renderer.h"
#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

/// Views through both lenses, whole and cut by the picture's rim: every id in its place.
TEST(Charuco, IsRefinedWholeAndInPart) {
  const Board board = test::make_board("charuco", 8, 6);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  struct View {
    Camera camera;
    Eigen::Vector3d bearing;
    double distance;
    double tilt;
    std::size_t least;  ///< corners, of 35
  };
  const View views[] = {{test::narrow_camera(), {0, 0.1, 1}, 1.2, 0.2, 34},
                        {test::narrow_camera(), {0, 0.1, 1}, 1.2, 0.9, 34},
                        {test::narrow_camera(), {0.55, 0.1, 1}, 1.2, 0.2, 12},
                        {test::fisheye_camera(), {0, 0.1, 1}, 0.45, 0.2, 34},
                        {test::fisheye_camera(), {1.7, 0.1, 1}, 0.45, 0.2, 30}};
  std::mt19937_64 random(7);
  for (const View& view : views) {
    const Pose truth = test::board_pose(view.bearing, view.distance, view.tilt, 1.2, 0.5);
    const auto pixels = test::true_corners(board, view.camera, truth);
    const Image image = test::render_board(board, view.camera, truth, {}, random);
    const auto corners = detect_board(board, image);
    EXPECT_GE(corners.size(), view.least);
    double sum = 0;
    for (const Corner& corner : corners) {
      const auto& pixel = pixels[static_cast<std::size_t>(corner.id)];
      ASSERT_TRUE(pixel);
      EXPECT_LT((corner.pixel - *pixel).norm(), 0.15) << corner.id;
      sum += (corner.pixel - *pixel).squaredNorm();
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(corners.size())), 0.03);
    const auto pose = estimate_board_pose(board, view.camera, corners);
    ASSERT_TRUE(pose) << pose.error().text();
    EXPECT_LT(truth.difference(pose->T_camera_board).norm(), 0.01);
  }
}

}  // namespace
}  // namespace ca2
