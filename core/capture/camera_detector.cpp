#include "core/capture/camera_detector.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "core/board/track_board.h"

namespace ca2 {
namespace {

// A board that was lost is looked for in every picture for so long, ns..
constexpr std::int64_t soon = 1'000'000'000;
// ..and after that not so soon after the last search, ns: in every picture of a camera of 10 Hz.
constexpr std::int64_t rest = 90'000'000;

Image crop(const Image& grey8, int x, int y, int width, int height) {
  Image part{width, height, 1, 8, {}};
  const auto row = static_cast<std::size_t>(width);
  part.bytes.resize(row * static_cast<std::size_t>(height));
  for (int r = 0; r < height; ++r) {
    const auto from =
        static_cast<std::size_t>(y + r) * static_cast<std::size_t>(grey8.width) + static_cast<std::size_t>(x);
    std::memcpy(part.bytes.data() + static_cast<std::size_t>(r) * row, grey8.bytes.data() + from, row);
  }
  return part;
}

Eigen::AlignedBox2d box_of(const std::vector<Corner>& corners) {
  Eigen::AlignedBox2d box;
  for (const Corner& corner : corners) box.extend(corner.pixel);
  return box;
}

}  // namespace

std::vector<Corner> CameraDetector::expected() const {
  std::map<int, Eigen::Vector2d> before;
  for (const Corner& corner : before_) before[corner.id] = corner.pixel;
  std::vector<Corner> corners = last_;
  for (Corner& corner : corners) {
    const auto was = before.find(corner.id);
    if (was != before.end()) corner.pixel += corner.pixel - was->second;
  }
  return corners;
}

std::vector<Corner> CameraDetector::search_region(const Image& grey8) const {
  const Eigen::AlignedBox2d box = box_of(last_);
  // The pattern's rim lies a square outside its corners; on top of that, the board may move on as it did.
  double margin = 0.3 * box.diagonal().norm() + 16;
  if (!before_.empty()) margin += (box.center() - box_of(before_).center()).norm();
  const auto low = [&](double v) { return std::max(0, static_cast<int>(std::floor(v - margin))); };
  const int x = low(box.min().x());
  const int y = low(box.min().y());
  const int width = std::min(grey8.width, static_cast<int>(std::ceil(box.max().x() + margin)) + 1) - x;
  const int height = std::min(grey8.height, static_cast<int>(std::ceil(box.max().y() + margin)) + 1) - y;
  if (width <= 0 || height <= 0) return {};
  std::vector<Corner> corners = board_.type->find(board_, crop(grey8, x, y, width, height));
  for (Corner& corner : corners) corner.pixel += Eigen::Vector2d(x, y);
  return corners;
}

/// Searches of all of a picture take ten times as long as tracking: a rig that waits for a person with a
/// board would take more of the computer than one in front of which the board is.
bool CameraDetector::spares(std::int64_t time) const {
  if (!away_since_ || !last_searched_) return false;
  const std::int64_t gap = time - *last_searched_;  // negative: the clock was set back
  return time - *away_since_ > soon && gap >= 0 && gap < rest;
}

std::vector<Corner> CameraDetector::find(const Image& image) {
  Image converted;
  const Image& grey8 = as_grey8(image, converted);
  std::vector<Corner> corners;
  if (!last_.empty()) corners = track_board(board_, grey8, expected());
  if (corners.empty() && !last_.empty()) corners = search_region(grey8);
  if (corners.empty()) corners = board_.type->find(board_, grey8);
  return corners;
}

CameraObservation CameraDetector::detect(std::int64_t time, std::shared_ptr<const Image> image) {
  CameraObservation observation;
  observation.camera = camera_;
  observation.time = time;
  if (spares(time)) {
    observation.searched = false;
    observation.spared = true;
    return observation;
  }
  before_ = std::exchange(last_, find(*image));
  last_searched_ = time;
  if (!last_.empty()) {
    away_since_.reset();
  } else if (!away_since_ || time < *away_since_) {
    away_since_ = time;
  }
  observation.image = std::move(image);
  observation.corners = last_;
  return observation;
}

}  // namespace ca2
