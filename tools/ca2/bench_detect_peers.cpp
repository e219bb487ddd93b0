#include "tools/ca2/bench_detect_peers.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

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

/// libapriltag, told that an AprilGrid's tags have a border of two cells and not of one. Two tags: eight
/// corners.
bool tags(const Board& board, const Image& grey8) {
  apriltag_family_t* const family = tag36h11_create();
  family->width_at_border += 2;
  family->total_width += 2;
  for (std::uint32_t i = 0; i < family->nbits; ++i) ++family->bit_x[i], ++family->bit_y[i];
  apriltag_detector_t* const detector = apriltag_detector_create();
  detector->nthreads = 1;
  detector->quad_decimate = 1;
  apriltag_detector_add_family_bits(detector, family, 1);
  image_u8_t view{grey8.width, grey8.height, grey8.width, const_cast<std::uint8_t*>(grey8.bytes.data())};
  zarray_t* const detections = apriltag_detector_detect(detector, &view);
  int count = 0;
  for (int i = 0; i < zarray_size(detections); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections, i, &detection);
    count += detection->id < board.columns * board.rows ? 1 : 0;
  }
  apriltag_detections_destroy(detections);
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
  return count >= 2;
}

}  // namespace

std::vector<PeerSearch> peer_searches(const Board& board) {
  if (board.type->name() == "checkerboard") {
    return {{"sector-based", sector_based}, {"default", default_search, true}};
  }
#ifdef CA2_WITH_CHARUCO
  if (board.type->name() == "charuco") return {{"markers", markers}};
#endif
  if (board.type->name() == "aprilgrid") return {{"libapriltag", tags}};
  return {};
}

}  // namespace ca2
