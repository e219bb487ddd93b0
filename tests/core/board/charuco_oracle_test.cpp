/// OpenCV's own detector of markers on what we draw, and ours beside it.
#ifdef CA2_WITH_CHARUCO
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <opencv2/aruco/charuco.hpp>

#include "tests/support/board_renderer.h"
#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

using cv::aruco::getPredefinedDictionary;

struct Named {
  const char* name;
  int id;
};

const Named dictionaries[] = {{"DICT_4X4_50", cv::aruco::DICT_4X4_50},
                              {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
                              {"DICT_4X4_250", cv::aruco::DICT_4X4_250},
                              {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
                              {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
                              {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
                              {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
                              {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
                              {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
                              {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
                              {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
                              {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
                              {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
                              {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
                              {"DICT_7X7_250", cv::aruco::DICT_7X7_250},
                              {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
                              {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL}};

/// The corners between markers that OpenCV reads, by id.
std::map<int, Eigen::Vector2d> read_by_markers(const Board& board, int dictionary_id, const Image& image) {
  const auto dictionary = getPredefinedDictionary(dictionary_id);
  const auto charuco =
      cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square),
                                      static_cast<float>(board.marker), dictionary);
  const cv::Mat picture(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.bytes.data()));
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids, ids;
  std::vector<cv::Point2f> pixels;
  cv::aruco::detectMarkers(picture, dictionary, markers, marker_ids);
  if (!marker_ids.empty()) {
    cv::aruco::interpolateCornersCharuco(markers, marker_ids, picture, charuco, pixels, ids);
  }
  std::map<int, Eigen::Vector2d> corners;
  // OpenCV 4.6 answers half a pixel too far down and right: it shifts for its sub-pixel search, not back.
  for (std::size_t i = 0; i < ids.size(); ++i) corners[ids[i]] = {pixels[i].x - 0.5, pixels[i].y - 0.5};
  return corners;
}

/// Boards of every dictionary, seen from near and far, even and odd: the ids we give are those OpenCV reads,
/// and we find at least as many corners.
TEST(CharucoOracle, ReadsTheSameIds) {
  const Camera camera = test::narrow_camera();
  std::mt19937_64 random(3);
  int number = 0;
  for (const Named& dictionary : dictionaries) {
    ++number;
    Board board = test::make_board("charuco", 6 + number % 3, 5 + number % 2);
    board.dictionary = dictionary.name;
    ASSERT_TRUE(board.type->invalid(board).empty()) << dictionary.name;
    const Pose pose =
        test::board_pose({0.05, 0.05, 1}, 0.7 + 0.03 * number, 0.5, 0.4 * number, 0.37 * number);
    const auto truth = test::true_corners(board, camera, pose);
    const Image image = test::render_board(board, camera, pose, {}, random);
    const auto theirs = read_by_markers(board, dictionary.id, image);
    EXPECT_GE(theirs.size(), truth.size() / 2) << dictionary.name;
    const auto ours = board.type->find(board, image);
    EXPECT_GE(ours.size(), theirs.size()) << dictionary.name;
    for (const auto& [id, pixel] : theirs) {
      EXPECT_LT((pixel - *truth[static_cast<std::size_t>(id)]).norm(), 3) << dictionary.name << ' ' << id;
    }
    for (const Corner& corner : ours) {
      EXPECT_LT((corner.pixel - *truth[static_cast<std::size_t>(corner.id)]).norm(), 0.5)
          << dictionary.name << ' ' << corner.id;
    }
  }
}

}  // namespace
}  // namespace ca2
#endif
