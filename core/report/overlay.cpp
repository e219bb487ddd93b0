#include "core/report/overlay.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ca2 {
namespace {

struct Dot {
  int x, y;
  double range;
};

double percentile(std::vector<double>& values, double share) {
  const auto index = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

void draw_disc(Image& image, const Dot& dot, int radius, Colour colour) {
  for (int y = std::max(0, dot.y - radius); y <= std::min(image.height - 1, dot.y + radius); ++y) {
    for (int x = std::max(0, dot.x - radius); x <= std::min(image.width - 1, dot.x + radius); ++x) {
      if ((x - dot.x) * (x - dot.x) + (y - dot.y) * (y - dot.y) > radius * radius) continue;
      std::uint8_t* pixel = image.bytes.data() + 3 * (static_cast<std::size_t>(y) * image.width + x);
      pixel[0] = colour.r;
      pixel[1] = colour.g;
      pixel[2] = colour.b;
    }
  }
}

}  // namespace

Colour range_colour(double share) {
  // Hue from red over yellow, green and cyan to blue, at full saturation.
  const double hue = 4 * std::clamp(share, 0.0, 1.0);
  const auto channel = [&](double centre) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(2 - std::abs(hue - centre), 0.0, 1.0)));
  };
  return {channel(0), channel(2), channel(4)};
}

Overlay draw_overlay(const Image& image, const Camera& camera, const Scan& scan, const Pose& T_camera_lidar) {
  const Image grey = to_grey8(image);
  Overlay overlay;
  overlay.image = {grey.width, grey.height, 3, 8, {}};
  overlay.image.bytes.resize(3 * grey.bytes.size());
  for (std::size_t i = 0; i < grey.bytes.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) overlay.image.bytes[3 * i + k] = grey.bytes[i];
  }
  std::vector<Dot> dots;
  std::vector<double> ranges;
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3d p = T_camera_lidar * point.cast<double>();
    const std::optional<Eigen::Vector2d> pixel = camera.project(p);
    if (!pixel || !camera.contains(*pixel)) continue;
    dots.push_back(
        {static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())), p.norm()});
    ranges.push_back(p.norm());
  }
  overlay.drawn = static_cast<int>(dots.size());
  if (dots.empty()) return overlay;
  overlay.near = percentile(ranges, 0.02);
  overlay.far = std::max(percentile(ranges, 0.98), overlay.near + 1e-3);
  std::stable_sort(dots.begin(), dots.end(), [](const Dot& a, const Dot& b) { return a.range > b.range; });
  const int radius = std::max(1, grey.width / 640);
  for (const Dot& dot : dots) {
    draw_disc(overlay.image, dot, radius,
              range_colour((dot.range - overlay.near) / (overlay.far - overlay.near)));
  }
  return overlay;
}

}  // namespace ca2
