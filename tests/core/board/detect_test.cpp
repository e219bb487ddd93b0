#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/io/files.h"
#include "tests/support/board_renderer.h"
#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

using test::RenderOptions;

/// Largest distance of a corner from the truth; ids of an ambiguous board may be turned by half.
double worst_error(const Board& board, const Camera& camera, const Pose& truth,
                   const std::vector<Corner>& found) {
  const auto pixels = test::true_corners(board, camera, truth);
  double straight = 0;
  double turned = board.type->half_turn_ambiguous(board) ? 0 : 1e9;
  for (const Corner& corner : found) {
    const auto id = static_cast<std::size_t>(corner.id);
    straight = std::max(straight, (corner.pixel - *pixels[id]).norm());
    turned = std::max(turned, (corner.pixel - *pixels[pixels.size() - 1 - id]).norm());
  }
  return std::min(straight, turned);
}

/// Views of all kinds: tilted to 65 degrees, rolled, sharp and blurred, out to the rim of a fisheye.
struct Views {
  const char* name;
  Camera camera;
  double off_axis;  ///< rad
  double nearest;   ///< m
  double farthest;  ///< m
};

class EveryView : public testing::TestWithParam<int> {};

TEST_P(EveryView, IsFoundInPlace) {
  const Views kinds[] = {{"narrow", test::narrow_camera(), 0.3, 1.1, 2.5},
                         {"fisheye", test::fisheye_camera(), 1.1, 0.3, 0.9},
                         {"large", test::large_camera(), 0.35, 1.4, 3.5}};
  const Views& kind = kinds[GetParam()];
  std::mt19937_64 random(100 + static_cast<unsigned>(GetParam()));
  std::uniform_real_distribution<double> unit(0, 1);
  const Board boards[] = {test::make_board("checkerboard", 8, 6), test::make_board("checkerboard", 8, 5)};
  int seen = 0;
  for (int attempt = 0; attempt < 400 && seen < 20; ++attempt) {
    const Board& board = boards[attempt % 2];
    const double off = kind.off_axis * unit(random);
    const double around = 2 * M_PI * unit(random);
    const Eigen::Vector3d bearing(std::sin(off) * std::cos(around), std::sin(off) * std::sin(around),
                                  std::cos(off));
    const double distance = kind.nearest + (kind.farthest - kind.nearest) * unit(random);
    const double tilt = 65 * M_PI / 180 * std::sqrt(unit(random));
    const double axis = 2 * M_PI * unit(random);
    const Pose truth = test::board_pose(bearing, distance, tilt, axis, 2 * M_PI * unit(random));
    bool inside = true;
    for (const auto& pixel : test::true_corners(board, kind.camera, truth)) {
      inside = inside && pixel && kind.camera.contains(*pixel, 10);
    }
    if (!inside) continue;
    ++seen;
    RenderOptions options;
    options.sigma = 0.5 + 1.0 * unit(random);
    const Image image = test::render_board(board, kind.camera, truth, options, random);
    const std::vector<Corner> found = board.type->find(board, image);
    SCOPED_TRACE(std::string(kind.name) + " view " + std::to_string(seen) + " tilt " + std::to_string(tilt) +
                 " blur " + std::to_string(options.sigma) + " distance " + std::to_string(distance));
    ASSERT_EQ(found.size(), board.type->corners(board).size());
    EXPECT_LT(worst_error(board, kind.camera, truth, found), 0.5);
  }
  EXPECT_EQ(seen, 20);
}

INSTANTIATE_TEST_SUITE_P(Cameras, EveryView, testing::Values(0, 1, 2));

TEST(Checkerboard, IsFoundWithSquaresOfEightPixels) {
  std::mt19937_64 random(5);
  const Board board = test::make_board("checkerboard", 8, 6);
  for (int i = 0; i < 8; ++i) {
    // 286 px/rad: 0.04 m at 1.43 m is 8 px.
    const Pose truth = test::board_pose({0.4, 0.3 - 0.1 * i, 1}, 1.43, 0.05 * i, 1, 0.4 * i);
    RenderOptions options;
    options.sigma = 0.7;
    const Image image = test::render_board(board, test::fisheye_camera(), truth, options, random);
    const auto found = board.type->find(board, image);
    ASSERT_EQ(found.size(), 48u) << i;
    EXPECT_LT(worst_error(board, test::fisheye_camera(), truth, found), 0.5) << i;
  }
}

TEST(Checkerboard, IsFoundBigBlurredAndDim) {
  std::mt19937_64 random(6);
  const Board board = test::make_board("checkerboard", 8, 5);
  RenderOptions options;
  options.sigma = 4;
  options.black = 40;
  options.white = 80;
  options.background = 60;
  options.noise = 3;
  const Pose truth = test::board_pose({0, 0.02, 1}, 0.45, 0.3, 1, 0.2);  // squares of 150 px
  const Image image = test::render_board(board, test::large_camera(), truth, options, random);
  const auto found = detect_board(board, image);
  ASSERT_EQ(found.size(), 40u);
  EXPECT_LT(worst_error(board, test::large_camera(), truth, found), 0.3);
}

TEST(Checkerboard, AnswersTheSameTwice) {
  std::mt19937_64 random(7);
  const Board board = test::make_board("checkerboard", 8, 6);
  const Pose truth = test::board_pose({0.1, 0, 1}, 1.5, 0.5, 1, 2);
  const Image image = test::render_board(board, test::narrow_camera(), truth, {}, random);
  const auto first = detect_board(board, image);
  const auto second = detect_board(board, image);
  ASSERT_EQ(first.size(), 48u);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].pixel, second[i].pixel);
    EXPECT_EQ(first[i].covariance, second[i].covariance);
  }
}

/// A chessboard of another size, or one of which a part is out of the picture, is not this board.
TEST(Checkerboard, IsNotAPieceOfAnother) {
  std::mt19937_64 random(8);
  const Camera camera = test::narrow_camera();
  const Board wanted = test::make_board("checkerboard", 8, 6);
  for (const auto& [columns, rows] : {std::pair(9, 6), std::pair(8, 7), std::pair(7, 6), std::pair(14, 11)}) {
    const Board other = test::make_board("checkerboard", columns, rows);
    const Image image =
        test::render_board(other, camera, test::board_pose({0, 0, 1}, 1.6, 0.4, 1, 1), {}, random);
    EXPECT_TRUE(wanted.type->find(wanted, image).empty()) << columns << " x " << rows;
    EXPECT_FALSE(other.type->find(other, image).empty()) << columns << " x " << rows;
  }
  const Image cut =
      test::render_board(wanted, camera, test::board_pose({0.52, 0, 1}, 1.6, 0, 1, 0), {}, random);
  EXPECT_TRUE(wanted.type->find(wanted, cut).empty());
}

TEST(Checkerboard, IsNotSeenInTextures) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const Board board = test::make_board("checkerboard", 8, 6);
  for (int blur = 1; blur <= 9; blur += 2) {
    cv::Mat noise(800, 848, CV_32F);
    for (int i = 0; i < 800 * 848; ++i)
      noise.at<float>(i / 848, i % 848) = static_cast<float>(normal(random));
    cv::GaussianBlur(noise, noise, {blur, blur}, 0);
    cv::Mat grey;
    cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
    noise.convertTo(grey, CV_8U);
    const Image image{848, 800, 1, 8, {grey.data, grey.data + grey.total()}};
    EXPECT_TRUE(board.type->find(board, image).empty()) << blur;
  }
  for (const auto& [w, h] : {std::pair(0, 0), std::pair(1, 1), std::pair(7, 3), std::pair(16, 16)}) {
    const Image tiny{w, h, 1, 8, std::vector<std::uint8_t>(static_cast<std::size_t>(w * h), 128)};
    EXPECT_TRUE(board.type->find(board, tiny).empty());
  }
}

/// Twenty real pictures of a fisheye lens; the board held as a diamond.
TEST(Checkerboard, IsFoundInRealPictures) {
  const char* data = std::getenv("CA2_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "CA2_TEST_DATA is not set: no real pictures";
  const Camera camera = test::make_camera(
      "kannala_brandt", {1176.93, 1177.72, 962.275, 612.725, -0.0540096, -0.0784275, 0.0959641, -0.0515253},
      1920, 1208);
  const Board board = test::make_board("checkerboard", 7, 5, 0.095);
  for (int i = 1; i < 40; i += 2) {
    const auto path =
        std::filesystem::path(data) / "acfr_vlp16/images" / ("pose" + std::to_string(i) + ".png");
    const auto image = read_png(path);
    ASSERT_TRUE(image) << image.error().text();
    const auto corners = detect_board(board, *image);
    ASSERT_EQ(corners.size(), 35u) << path;
    const auto pose = estimate_board_pose(board, camera, corners);
    ASSERT_TRUE(pose) << pose.error().text();
    // The published intrinsics leave 0.08 to 0.35 px.
    EXPECT_LT(pose->reprojection_rms, 0.4) << path;
  }
}

}  // namespace
}  // namespace ca2
