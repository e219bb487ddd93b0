#include "tools/ca2/bench_detect_peers.h"

#include <opencv2/calib3d.hpp>

#ifdef CA2_WITH_CHARUCO
#include <opencv2/aruco/charuco.hpp>
#endif

namespace ca2 {
namespace {

cv::Mat matrix(const Image& grey8) {
  return {grey8.height, grey8.width, CV_8UC1, const_cast<std::uint8_t*>(grey8.bytes.data())};
}

bool sector_based(const Board& board, const Image& grey8) {
  std::vector<cv::Point2f> corners;
  return cv::findChessboardCornersSB(matrix(grey8), {board.columns, board.rows}, corners,
                                     cv::CALIB_CB_EXHAUSTIVE);
}

bool default_search(const Board& board, const Image& grey8) {
  std::vector<cv::Point2f> corners;
  return cv::findChessboardCorners(matrix(grey8), {board.columns, board.rows}, corners);
}

#ifdef CA2_WITH_CHARUCO
/// For a board of DICT_5X5_100. Six corners, as from ours.
bool markers(const Board& board, const Image& grey8) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100);
  const auto charuco =
      cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square),
                                      static_cast<float>(board.marker), dictionary);
  std::vector<std::vector<cv::Point2f>> marker_corners;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(matrix(grey8), dictionary, marker_corners, marker_ids);
  if (marker_ids.empty()) return false;
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  return cv::aruco::interpolateCornersCharuco(marker_corners, marker_ids, matrix(grey8), charuco, corners,
                                              ids) >= 6;
}
#endif

}  // namespace

std::vector<PeerSearch> peer_searches(const Board& board) {
  if (board.type->name() == "checkerboard") {
    return {{"sector-based", sector_based}, {"default", default_search, true}};
  }
#ifdef CA2_WITH_CHARUCO
  if (board.type->name() == "charuco") return {{"markers", markers}};
#endif
  return {};
}

}  // namespace ca2
