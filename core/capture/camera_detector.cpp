#include "core/capture/camera_detector.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace ca2 {
namespace {

Image crop(const Image& image, int x, int y, int width, int height) {
  Image part{width, height, image.channels, image.bits, {}};
  const std::size_t pixel = image.bytes_per_pixel(), row = static_cast<std::size_t>(width) * pixel;
  part.bytes.resize(row * static_cast<std::size_t>(height));
  for (int r = 0; r < height; ++r) {
    const std::size_t from = (static_cast<std::size_t>(y + r) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x)) *
                             pixel;
    std::memcpy(part.bytes.data() + static_cast<std::size_t>(r) * row, image.bytes.data() + from, row);
  }
  return part;
}

Eigen::AlignedBox2d box_of(const std::vector<Corner>& corners) {
  Eigen::AlignedBox2d box;
  for (const Corner& corner : corners) box.extend(corner.pixel);
  return box;
}

}  // namespace

std::optional<CameraDetector::Region> CameraDetector::predict(const Image& image) const {
  if (last_.empty()) return std::nullopt;
  const Eigen::AlignedBox2d box = box_of(last_);
  // The pattern's rim lies a square outside its corners; on top of that, the board may move on as it did.
  double margin = 0.3 * box.diagonal().norm() + 16;
  if (!before_.empty()) margin += (box.center() - box_of(before_).center()).norm();
  const auto low = [&](double v) { return std::max(0, static_cast<int>(std::floor(v - margin))); };
  Region region;
  region.x = low(box.min().x());
  region.y = low(box.min().y());
  region.width = std::min(image.width, static_cast<int>(std::ceil(box.max().x() + margin)) + 1) - region.x;
  region.height = std::min(image.height, static_cast<int>(std::ceil(box.max().y() + margin)) + 1) - region.y;
  if (region.width <= 0 || region.height <= 0) return std::nullopt;
  return region;
}

CameraObservation CameraDetector::detect(std::int64_t time, std::shared_ptr<const Image> image) {
  CameraObservation observation;
  observation.camera = camera_;
  observation.time = time;
  if (const std::optional<Region> region = predict(*image)) {
    observation.corners =
        detect_board(board_, crop(*image, region->x, region->y, region->width, region->height));
    for (Corner& corner : observation.corners) corner.pixel += Eigen::Vector2d(region->x, region->y);
  }
  if (observation.corners.empty()) observation.corners = detect_board(board_, *image);
  before_ = std::move(last_);
  last_ = observation.corners;
  observation.image = std::move(image);
  return observation;
}

}  // namespace ca2
