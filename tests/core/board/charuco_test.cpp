#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string_view>

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

/// Where the picture's rim cuts the board, crossings beside it are not seen: none is guessed beyond, and what
/// is given has a covariance that is one.
TEST(Charuco, HasNoCornersBeyondThePicture) {
  const Board board = test::make_board("charuco", 8, 6);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  const Camera camera = test::narrow_camera();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::size_t found = 0;
  for (int k = 0; k < 8; ++k) {
    // The middle of the board near the left, right, upper or lower rim.
    Eigen::Vector3d bearing(0.5 * uniform(random), 0.38 * uniform(random), 1);
    if (k % 2 == 0) bearing.x() = (k % 4 == 0 ? 1 : -1) * (0.5 + 0.03 * uniform(random));
    if (k % 2 == 1) bearing.y() = (k % 4 == 1 ? 1 : -1) * (0.38 + 0.03 * uniform(random));
    const Pose pose = test::board_pose(bearing, 0.9, 0.6, 3 * uniform(random), 0.4 * uniform(random));
    const Image image = test::render_board(board, camera, pose, {}, random);
    for (const Corner& corner : detect_board(board, image)) {
      ++found;
      EXPECT_GE(corner.pixel.minCoeff(), 0) << corner.id;
      EXPECT_LE(corner.pixel.x(), camera.width - 1) << corner.id;
      EXPECT_LE(corner.pixel.y(), camera.height - 1) << corner.id;
      EXPECT_GT(corner.covariance(0, 0), 0) << corner.id;
      EXPECT_GT(corner.covariance.determinant(), 0) << corner.id;
    }
  }
  EXPECT_GT(found, 60u);
}

/// Squares of 13 px: no marker can be read alone. A board without markers is another one.
TEST(Charuco, IsToldByThePrintWhereMarkersAreTooSmall) {
  const Board board = test::make_board("charuco", 8, 6);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  const Camera camera = test::narrow_camera();
  const Pose pose = test::board_pose({0.1, 0.1, 1}, 3.8, 0.2, 1.2, 0.5);
  const auto pixels = test::true_corners(board, camera, pose);
  std::mt19937_64 random(7);
  const Image image = test::render_board(board, camera, pose, {}, random);
  const auto whole = detect_board(board, image);
  EXPECT_GE(whole.size(), 34u);
  for (const Corner& corner : whole) {
    EXPECT_LT((corner.pixel - *pixels[static_cast<std::size_t>(corner.id)]).norm(), 0.15) << corner.id;
  }
  const Image other = test::render_board(test::make_board("checkerboard", 7, 5), camera, pose, {}, random);
  EXPECT_TRUE(detect_board(board, other).empty());
}

/// Squares of 8 to 13 px at all tilts: the gap between a corner and the marker beside it is less than two
/// pixels. More than half of such boards are found, none in a wrong place.
TEST(Charuco, IsFoundWhereMarkersTouchTheCorners) {
  const Board board = test::make_board("charuco", 10, 7);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  const Camera camera = test::narrow_camera();
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> unit(0, 1);
  int found = 0, views = 0;
  for (const double square : {8.0, 9.0, 10.0, 11.0, 12.0, 13.0}) {
    for (int i = 0; i < 5; ++i, ++views) {
      const Eigen::Vector3d bearing(0.4 * unit(random) - 0.2, 0.3 * unit(random) - 0.15, 1);
      const double tilt = 0.1 + 0.5 * unit(random), axis = 6.28 * unit(random), roll = unit(random) - 0.5;
      const Pose pose = test::board_pose(bearing, 1250 * board.square / square, tilt, axis, roll);
      const auto pixels = test::true_corners(board, camera, pose);
      const auto corners = detect_board(board, test::render_board(board, camera, pose, {}, random));
      for (const Corner& corner : corners)
        EXPECT_LT((corner.pixel - *pixels[static_cast<std::size_t>(corner.id)]).norm(), 0.5) << square;
      found += 2 * corners.size() > pixels.size() ? 1 : 0;
    }
  }
  std::printf("found in %d of %d views\n", found, views);
  EXPECT_GE(found, 0.5 * views);
}

/// Where some corners cannot be told a board is seen in pieces, none of which shows enough of the print: all
/// of them together do.
TEST(Charuco, IsToldByItsPiecesTogether) {
  const Board board = test::make_board("charuco", 11, 8, 0.036);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  const Camera camera = test::fisheye_camera();
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  int found = 0, views = 0;
  for (; views < 40; ++views) {
    const Eigen::Vector3d bearing(1.2 * unit(random) - 0.6, 1.2 * unit(random) - 0.6, 1);
    const double tilt = 0.6 * std::sqrt(unit(random)), axis = 6.28 * unit(random);
    const Pose pose =
        test::board_pose(bearing, 0.9 + 0.15 * unit(random), tilt, axis, 0.6 * unit(random) - 0.3);
    const auto pixels = test::true_corners(board, camera, pose);
    const auto corners = detect_board(board, test::render_board(board, camera, pose, {}, random));
    for (const Corner& corner : corners)
      EXPECT_LT((corner.pixel - *pixels[static_cast<std::size_t>(corner.id)]).norm(), 0.5);
    found += 2 * corners.size() > pixels.size() ? 1 : 0;
  }
  std::printf("found in %d of %d views\n", found, views);
  EXPECT_GE(found, 0.9 * views);
}

/// Views in which few or none of the markers can be read one by one, or the board is in pieces.
struct HardViews {
  const char* name;
  int columns, rows;
  Camera camera;
  double off_axis;           ///< rad
  double nearest, farthest;  ///< m
  test::RenderOptions look;
  bool arm;  ///< before the board, across the picture
};

void PrintTo(const HardViews& views, std::ostream* out) {
  *out << views.name;
}

std::vector<HardViews> hard_views() {
  test::RenderOptions usual, dim, noisy;
  dim.black = 25, dim.white = 50, dim.background = 40;
  noisy.noise = 16;
  Camera cut = test::fisheye_camera();
  cut.width = 640, cut.height = 480;
  cut.parameters[2] = 320, cut.parameters[3] = 240;
  return {{"filling the picture", 11, 8, test::narrow_camera(), 0.35, 0.12, 0.35, usual, false},
          {"cut by a fisheye's picture", 8, 6, cut, 1.0, 0.2, 0.4, usual, false},
          {"six corners", 4, 3, test::fisheye_camera(), 1.0, 0.15, 0.4, usual, false},
          {"dim", 8, 6, test::narrow_camera(), 0.3, 0.7, 1.6, dim, false},
          {"noisy", 8, 6, test::narrow_camera(), 0.3, 0.8, 2.0, noisy, false},
          {"behind an arm", 9, 6, test::narrow_camera(), 0.2, 0.8, 1.5, usual, true}};
}

class CharucoViews : public testing::TestWithParam<HardViews> {};

TEST_P(CharucoViews, AreFoundInPlace) {
  const HardViews& kind = GetParam();
  const Board board = test::make_board("charuco", kind.columns, kind.rows);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  int views = 0;
  for (int attempt = 0; attempt < 400 && views < 6; ++attempt) {
    const double off = kind.off_axis * unit(random), around = 2 * M_PI * unit(random);
    const Eigen::Vector3d bearing(std::sin(off) * std::cos(around), std::sin(off) * std::sin(around),
                                  std::cos(off));
    const double distance = kind.nearest + (kind.farthest - kind.nearest) * unit(random);
    const double tilt = 0.8 * unit(random), axis = 2 * M_PI * unit(random);
    const Pose pose = test::board_pose(bearing, distance, tilt, axis, 2 * M_PI * unit(random));
    auto pixels = test::true_corners(board, kind.camera, pose);
    const double middle = kind.camera.parameters[3] + 0.1 * kind.camera.height * (unit(random) - 0.5);
    const auto hidden = [&](double y) { return kind.arm && std::abs(y - middle) < 35; };
    std::size_t visible = 0;
    for (auto& pixel : pixels) {
      if (pixel && (!kind.camera.contains(*pixel, 4) || hidden(pixel->y()))) pixel.reset();
      visible += pixel ? 1 : 0;
    }
    if (visible < 6) continue;
    ++views;
    Image image = test::render_board(board, kind.camera, pose, kind.look, random);
    for (int y = 0; y < image.height; ++y) {
      const auto row = image.bytes.begin() + static_cast<std::ptrdiff_t>(y) * image.width;
      if (hidden(y)) std::fill(row, row + image.width, std::uint8_t{140});
    }
    const auto corners = detect_board(board, image);
    for (const Corner& corner : corners) {
      const auto& pixel = pixels[static_cast<std::size_t>(corner.id)];
      if (!pixel) continue;
      EXPECT_LT((corner.pixel - *pixel).norm(), 0.7) << "view " << views << ", id " << corner.id;
    }
    EXPECT_GE(2 * corners.size(), visible) << "view " << views;
  }
  EXPECT_EQ(views, 6);
}

INSTANTIATE_TEST_SUITE_P(Charuco, CharucoViews, testing::ValuesIn(hard_views()));

/// Another dictionary's board, and the board in a mirror.
TEST(Charuco, IsNotAnother) {
  const Board board = test::make_board("charuco", 8, 6);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  const Camera camera = test::narrow_camera();
  std::mt19937_64 random(31);
  for (const double distance : {1.2, 2.8}) {
    const Pose pose = test::board_pose({0.05, 0.02, 1}, distance, 0.4, 1.1, 0.6);
    for (const char* dictionary : {"DICT_4X4_50", "DICT_5X5_1000", "DICT_6X6_100", "DICT_7X7_50"}) {
      Board other = board;
      other.dictionary = dictionary;
      // The larger dictionaries of a size begin as the smaller ones do.
      const bool same = std::string_view(dictionary).substr(0, 8) == "DICT_5X5";
      const Image image = test::render_board(other, camera, pose, {}, random);
      EXPECT_EQ(detect_board(board, image).empty(), !same) << dictionary << ' ' << distance;
    }
    Image mirrored = test::render_board(board, camera, pose, {}, random);
    for (int y = 0; y < mirrored.height; ++y) {
      const auto row = mirrored.bytes.begin() + static_cast<std::ptrdiff_t>(y) * mirrored.width;
      std::reverse(row, row + mirrored.width);
    }
    EXPECT_TRUE(detect_board(board, mirrored).empty()) << distance;
  }
}

/// A hand hides corners, and no others than those under it.
TEST(Charuco, LacksWhatIsCovered) {
  const Board board = test::make_board("charuco", 8, 6);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  const Camera camera = test::narrow_camera();
  const Pose pose = test::board_pose({0.1, 0.1, 1}, 1.8, 0.2, 1.2, 0.5);
  const auto pixels = test::true_corners(board, camera, pose);
  std::mt19937_64 random(7);
  Image image = test::render_board(board, camera, pose, {}, random);
  const Eigen::Vector2d hand = *pixels[0];
  const auto covered = [&](const Eigen::Vector2d& p, double more) {
    return (p - hand).cwiseAbs().maxCoeff() <= 40 + more;
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (covered(Eigen::Vector2d(x, y), 0)) {
        image.bytes[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + x] = 150;
      }
    }
  }
  const auto part = detect_board(board, image);
  EXPECT_GE(part.size(), 20u);
  for (const Corner& corner : part) {
    const Eigen::Vector2d& truth = *pixels[static_cast<std::size_t>(corner.id)];
    EXPECT_FALSE(covered(truth, 0)) << corner.id;
    EXPECT_LT((corner.pixel - truth).norm(), covered(truth, 8) ? 0.5 : 0.15) << corner.id;
  }
}

}  // namespace
}  // namespace ca2
