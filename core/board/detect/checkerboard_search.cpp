#include "core/board/detect/checkerboard_search.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace ca2 {

std::vector<Corner> find_checkerboard(int columns, int rows, const Image& grey8) {
  if (grey8.empty()) return {};
  const cv::Mat picture(grey8.height, grey8.width, CV_8UC1, const_cast<std::uint8_t*>(grey8.bytes.data()));
  std::vector<cv::Point2f> pixels;
  if (!cv::findChessboardCornersSB(picture, {columns, rows}, pixels)) return {};
  std::vector<Corner> corners;
  for (const cv::Point2f& pixel : pixels) {
    corners.push_back({static_cast<int>(corners.size()), {pixel.x, pixel.y}, Eigen::Matrix2d::Identity()});
  }
  return corners;
}

}  // namespace ca2
