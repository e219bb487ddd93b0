#include "daemon/publish/preview.h"

#include <algorithm>
#include <cmath>

#include "core/io/jpeg.h"
#include "core/lidar/projection.h"

namespace ca2 {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour corner_colour{0, 230, 60}, board_colour{255, 120, 0};

Image canvas(int width, int height) {
  Image image{width, height, 3, 8, {}};
  image.bytes.assign(static_cast<std::size_t>(width) * height * 3, 0);
  return image;
}

void paint(Image& image, int x, int y, const Colour& colour) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  std::copy(colour.begin(), colour.end(),
            image.bytes.begin() + 3 * (static_cast<std::ptrdiff_t>(y) * image.width + x));
}

/// Means of `step` x `step` pixels.
Image shrunk(const Image& grey, int step) {
  Image out = canvas(std::max(1, grey.width / step), std::max(1, grey.height / step));
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      unsigned sum = 0, count = 0;
      for (int v = y * step; v < std::min(grey.height, (y + 1) * step); ++v) {
        for (int u = x * step; u < std::min(grey.width, (x + 1) * step); ++u, ++count) {
          sum += grey.bytes[static_cast<std::size_t>(v) * grey.width + u];
        }
      }
      const auto mean = static_cast<std::uint8_t>(sum / std::max(1u, count));
      paint(out, x, y, {mean, mean, mean});
    }
  }
  return out;
}

void cross(Image& image, int x, int y) {
  for (int i = -2; i <= 2; ++i) {
    paint(image, x + i, y, corner_colour);
    paint(image, x, y + i, corner_colour);
  }
}

/// Every second pixel of every second row.
Image halved(const Image& image) {
  Image out = canvas(std::max(1, image.width / 2), std::max(1, image.height / 2));
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const std::uint8_t* from = &image.bytes[3 * (static_cast<std::size_t>(2 * y) * image.width + 2 * x)];
      paint(out, x, y, {from[0], from[1], from[2]});
    }
  }
  return out;
}

/// As good as the limit allows; what is noise all over, smaller.
Result<Preview> encoded(const Image& image, std::int64_t time, bool sees_board) {
  for (int quality = 75; quality >= 15; quality -= 20) {
    Result<std::string> jpeg = encode_jpeg(image, quality);
    if (!jpeg) return fail(jpeg.error());
    if (jpeg->size() <= max_preview_bytes) {
      return Preview{time, image.width, image.height, sees_board, std::move(*jpeg)};
    }
  }
  return encoded(halved(image), time, sees_board);
}

}  // namespace

Result<Preview> preview_of(const CameraObservation& observation, int width) {
  if (!observation.image || observation.image->empty()) {
    return fail(ErrorCode::unavailable, "", "there is no picture yet");
  }
  const Image grey = to_grey8(*observation.image);
  const int step = std::max(1, (grey.width + width - 1) / width);
  Image image = shrunk(grey, step);
  for (const Corner& corner : observation.corners) {
    // The centre of a shrunk pixel is (step - 1) / 2 beyond its first.
    const Eigen::Vector2d at = (corner.pixel.array() - 0.5 * (step - 1)) / step;
    cross(image, static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  }
  return encoded(image, observation.time, !observation.corners.empty());
}

Result<Preview> preview_of(const LidarObservation& observation, int width) {
  if (!observation.scan || observation.scan->empty()) {
    return fail(ErrorCode::unavailable, "", "there is no scan yet");
  }
  const Projection projection = project_by_id(*observation.scan);
  if (projection.range.empty()) return fail(ErrorCode::unavailable, "", "the scan has no returns");
  const int step = std::max(1, (projection.columns + width - 1) / width);
  // Few rings are drawn thick, so that the picture is not a line.
  const int rings = static_cast<int>(projection.by_elevation.size());
  const int thick = std::max(1, width / 8 / std::max(1, rings));
  Image image = canvas(std::max(1, projection.columns / step), std::max(1, rings * thick));
  const LidarSight* sight = observation.sights.empty() ? nullptr : &observation.sights.front();
  double reach = 0;  // of the board round its centre, m
  if (sight) {
    for (const BoardReturn& one : sight->on_board) {
      reach = std::max(reach, (one.point.cast<double>() - sight->center).norm());
    }
  }
  const auto on_board = [&](const Eigen::Vector3d& p) {
    return sight && (p - sight->center).norm() <= reach && std::abs(sight->plane.distance(p)) < 0.05;
  };
  for (int row = 0; row < rings; ++row) {
    const int ring = projection.by_elevation[static_cast<std::size_t>(rings - 1 - row)];  // highest on top
    for (int x = 0; x < image.width; ++x) {
      float nearest = 0;
      bool board = false;
      for (int column = x * step; column < std::min(projection.columns, (x + 1) * step); ++column) {
        const float r = projection.range[projection.index(ring, column)];
        if (r > 0 && (nearest == 0 || r < nearest)) nearest = r;
        for (const std::uint32_t i : projection.cell(ring, column)) {
          board |= on_board(observation.scan->points[i].cast<double>());
        }
      }
      if (nearest <= 0) continue;
      // Logarithmic from 0.5 m (white) to 30 m (dark grey).
      const double grey = 255 - 215 * std::clamp(std::log(nearest / 0.5) / std::log(60.0), 0.0, 1.0);
      const auto level = static_cast<std::uint8_t>(grey);
      for (int i = 0; i < thick; ++i) {
        paint(image, x, row * thick + i, board ? board_colour : Colour{level, level, level});
      }
    }
  }
  return encoded(image, observation.time, sight != nullptr);
}

}  // namespace ca2
