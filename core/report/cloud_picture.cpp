#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/report/overlay.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

/// The picture's colour at a pixel.
Colour colour_at(const Image& image, const Eigen::Vector2d& pixel) {
  const auto x = static_cast<std::size_t>(std::clamp<long>(std::lround(pixel.x()), 0, image.width - 1));
  const auto y = static_cast<std::size_t>(std::clamp<long>(std::lround(pixel.y()), 0, image.height - 1));
  const std::size_t at = (y * static_cast<std::size_t>(image.width) + x) * image.bytes_per_pixel();
  const auto channel = [&](std::size_t k) {
    if (image.bits == 8) return image.bytes[at + k];
    std::uint16_t value = 0;
    std::memcpy(&value, image.bytes.data() + at + 2 * k, 2);
    return static_cast<std::uint8_t>(value >> 8);
  };
  if (image.channels == 1) return {channel(0), channel(0), channel(0)};
  return {channel(0), channel(1), channel(2)};
}

}  // namespace

Image draw_cloud(const Image& image, const std::vector<SeenPoint>& seen, const Scan& scan,
                 const Pose& T_camera_lidar) {
  constexpr int width = 1000, height = 620;
  Image result{width, height, 3, 8, std::vector<std::uint8_t>(3ul * width * height, 24)};
  std::vector<Eigen::Vector3d> points;
  std::vector<Colour> colours;
  std::vector<double> ranges;
  const auto add = [&](const Eigen::Vector3d& p, Colour colour) {
    points.push_back(p);
    colours.push_back(colour);
    ranges.push_back(p.norm());
  };
  for (const Eigen::Vector3f& p : scan.points) {
    if (p.allFinite() && p.squaredNorm() > 1e-4f) add(T_camera_lidar * p.cast<double>(), {70, 70, 78});
  }
  const std::size_t scan_points = points.size();
  for (const SeenPoint& s : seen) add(s.point, colour_at(image, s.pixel));
  if (points.empty()) return result;
  const auto most =
      ranges.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(ranges.size() - 1));
  std::nth_element(ranges.begin(), most, ranges.end());
  const double reach = std::max(1.0, 1.1 * *most);
  // The eye is behind the camera and above it, and looks 25 degrees down along the camera's axis.
  const double tilt = 25 * M_PI / 180, back = 0.55 * reach;
  Eigen::Matrix3d R;
  R << 1, 0, 0, 0, std::cos(tilt), -std::sin(tilt), 0, std::sin(tilt), std::cos(tilt);
  const Eigen::Vector3d eye = -back * R.row(2).transpose();
  std::vector<float> depth(static_cast<std::size_t>(width) * height, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = R * (points[i] - eye);
    const int size = i < scan_points ? 2 : 3;  // px
    const double left = width / 2.0 + 0.9 * width * p.x() / p.z();
    const double top = height / 2.0 + 0.9 * width * p.y() / p.z();
    // Not so of what is no number, either: clouds of others have returns at 1e30 m.
    if (!(p.z() >= 0.1 && left > -size && left < width && top > -size && top < height)) continue;
    const int x = static_cast<int>(left);
    const int y = static_cast<int>(top);
    for (int v = y; v < y + size; ++v) {
      for (int u = x; u < x + size; ++u) {
        if (u < 0 || v < 0 || u >= width || v >= height) continue;
        const std::size_t at = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
        // The coloured ones come later and lie on the grey ones: a hair decides.
        if (p.z() > static_cast<double>(depth[at]) + 1e-4) continue;
        depth[at] = static_cast<float>(p.z());
        result.bytes[3 * at] = colours[i].r;
        result.bytes[3 * at + 1] = colours[i].g;
        result.bytes[3 * at + 2] = colours[i].b;
      }
    }
  }
  return result;
}

std::string coloured_ply(const Image& image, const std::vector<SeenPoint>& seen, const Scan& scan) {
  std::string out = formatted(
      "ply\nformat binary_little_endian 1.0\ncomment LiDAR frame, m; colours of the camera\nelement vertex "
      "%zu\n"
      "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nend_header\n",
      seen.size());
  for (const SeenPoint& s : seen) {
    const Eigen::Vector3f& p = scan.points[s.index];
    for (int k = 0; k < 3; ++k) {
      std::uint32_t bits = 0;
      const float value = p(k);
      std::memcpy(&bits, &value, 4);
      for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(bits >> shift & 0xff);
    }
    const Colour colour = colour_at(image, s.pixel);
    out += {static_cast<char>(colour.r), static_cast<char>(colour.g), static_cast<char>(colour.b)};
  }
  return out;
}

}  // namespace ca2
