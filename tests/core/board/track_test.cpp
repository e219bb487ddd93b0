#include "core/board/track_board.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/support/board_renderer.h"
#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

struct Scene {
  const char* name;
  Board board;
  Camera camera;
  double distance;         ///< m
  std::size_t missed = 0;  ///< corners that the search finds and the track may not
};

class Tracking : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (!scene().board.type) GTEST_SKIP() << "built without ChArUco";
  }

  Scene scene() const {
    const Scene scenes[] = {
        {"narrow", test::make_board("checkerboard", 8, 6), test::narrow_camera(), 1.6},
        {"fisheye", test::make_board("checkerboard", 8, 5), test::fisheye_camera(), 0.6},
        {"charuco", test::make_board("charuco", 9, 7), test::narrow_camera(), 1.2},
        {"small charuco", test::make_board("charuco", 9, 7), test::narrow_camera(), 2.2},
        {"charuco in a fisheye", test::make_board("charuco", 9, 7), test::fisheye_camera(), 0.7, 3},
    };
    return scenes[GetParam()];
  }

  /// The board turned and moved `step` m to the side of where it is held.
  static Pose pose(const Scene& s, double step) {
    Pose T = test::board_pose(Eigen::Vector3d(0.1, -0.05, 1), s.distance, 0.45, 0.7, 0.3);
    T.t += Eigen::Vector3d(step, -0.7 * step, 0.5 * step);
    T.R = T.R * so3_exp({step, 0.5 * step, 2 * step});
    return T;
  }

  Image picture(const Scene& s, const Pose& T) {
    return test::render_board(s.board, s.camera, T, test::RenderOptions{}, random_);
  }

  std::mt19937_64 random_{5};
};

/// Paints grey over the surroundings of a place.
void cover(Image& image, const Eigen::Vector2d& at, int reach) {
  for (int y = std::max(0, static_cast<int>(at.y()) - reach);
       y <= std::min(image.height - 1, static_cast<int>(at.y()) + reach); ++y) {
    for (int x = std::max(0, static_cast<int>(at.x()) - reach);
         x <= std::min(image.width - 1, static_cast<int>(at.x()) + reach); ++x) {
      image.bytes[static_cast<std::size_t>(y * image.width + x)] = 120;
    }
  }
}

double spacing(const std::vector<Corner>& corners) {
  return (corners[1].pixel - corners[0].pixel).norm();
}

TEST_P(Tracking, FollowsAMovingBoardToWhereTheSearchFindsIt) {
  const Scene s = scene();
  std::vector<Corner> corners = s.board.type->find(s.board, picture(s, pose(s, 0)));
  ASSERT_FALSE(corners.empty());
  for (int frame = 1; frame <= 5; ++frame) {
    const Image image = picture(s, pose(s, 0.002 * s.distance * frame));
    corners = track_board(s.board, image, corners);
    std::map<int, Eigen::Vector2d> searched;
    for (const Corner& corner : s.board.type->find(s.board, image)) searched[corner.id] = corner.pixel;
    ASSERT_GE(corners.size() + s.missed, searched.size()) << frame;
    for (const Corner& corner : corners) {
      if (searched.count(corner.id) == 0) continue;
      EXPECT_LT((corner.pixel - searched[corner.id]).norm(), 0.02);
    }
  }
}

TEST_P(Tracking, LosesCoveredCornersAndFindsThemAgain) {
  const Scene s = scene();
  const Image open = picture(s, pose(s, 0));
  const std::vector<Corner> all = track_board(s.board, open, s.board.type->find(s.board, open));
  ASSERT_FALSE(all.empty());
  Image covered = open;
  cover(covered, all.front().pixel, static_cast<int>(0.4 * spacing(all)));
  const std::vector<Corner> fewer = track_board(s.board, covered, all);
  ASSERT_LT(fewer.size(), all.size());
  ASSERT_GE(fewer.size() + 4, all.size());
  for (const Corner& corner : fewer) EXPECT_NE(corner.id, all.front().id);
  EXPECT_EQ(track_board(s.board, open, fewer).size(), all.size());
}

TEST_P(Tracking, KnowsABoardThatIsOneSquareAway) {
  const Scene s = scene();
  const Image image = picture(s, pose(s, 0));
  const std::vector<Corner> all = track_board(s.board, image, s.board.type->find(s.board, image));
  std::map<int, Eigen::Vector2d> pixels;
  for (const Corner& corner : all) pixels[corner.id] = corner.pixel;
  const int columns = s.board.type->repeats(s.board) ? s.board.columns : s.board.columns - 1;
  // One to the side makes black of white, one each way does not.
  for (const int shift : {1, columns, columns + 1}) {
    std::vector<Corner> shifted;
    for (const Corner& corner : all) {
      if (pixels.count(corner.id + shift) == 0) continue;
      shifted.push_back({corner.id, pixels[corner.id + shift], corner.covariance});
    }
    EXPECT_TRUE(track_board(s.board, image, shifted).empty()) << shift;
  }
}

TEST_P(Tracking, SeesThatTheBoardIsGone) {
  const Scene s = scene();
  const Image image = picture(s, pose(s, 0));
  const std::vector<Corner> all = s.board.type->find(s.board, image);
  EXPECT_TRUE(track_board(s.board, picture(s, pose(s, 0.4 * s.distance)), all).empty());
  Image noise = image;
  for (std::uint8_t& grey : noise.bytes) grey = static_cast<std::uint8_t>(random_() % 256);
  EXPECT_TRUE(track_board(s.board, noise, all).empty());
  Image tiny{5, 4, 1, 8, std::vector<std::uint8_t>(20, 9)};
  EXPECT_TRUE(track_board(s.board, tiny, all).empty());
}

TEST_P(Tracking, SurvivesExpectationsOutsideThePicture) {
  const Scene s = scene();
  const Image image = picture(s, pose(s, 0));
  std::vector<Corner> far = s.board.type->find(s.board, image);
  for (Corner& corner : far) corner.pixel *= 1e7;
  EXPECT_TRUE(track_board(s.board, image, far).empty());
  for (Corner& corner : far) corner.pixel.setConstant(std::nan(""));
  EXPECT_TRUE(track_board(s.board, image, far).empty());
}

INSTANTIATE_TEST_SUITE_P(Boards, Tracking, testing::Values(0, 1, 2, 3, 4));

}  // namespace
}  // namespace ca2
