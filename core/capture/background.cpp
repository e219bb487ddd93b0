#include "core/capture/background.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lidar/scan_grid.h"

namespace ca2 {
namespace {

constexpr int columns = 360;         // a degree: every revolution of every LiDAR meets each
constexpr float row_step = 0.0175f;  // rad: a degree, too; beams farther apart leave rows empty
constexpr int rows = 180;            // over all elevations
constexpr std::int64_t epoch_length = 30'000'000'000;  // ns
constexpr std::int64_t first_look = 1'000'000'000;     // ns

}  // namespace

std::size_t Background::cell(const Eigen::Vector3f& p) const {
  constexpr float pi = std::numbers::pi_v<float>;
  const float turn = (fast_azimuth(p.x(), p.y()) + pi) / (2 * pi);
  const float elevation = fast_azimuth(std::hypot(p.x(), p.y()), p.z());
  const int column = std::clamp(static_cast<int>(turn * columns), 0, columns - 1);
  const int row = std::clamp(static_cast<int>((elevation + pi / 2) / row_step), 0, rows - 1);
  return static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
}

void Background::add(const Scan& scan, std::int64_t time) {
  if (empty_ || time < newest_) {  // the first scan, or the clock was set back
    first_ = epoch_ = time;
    farthest_.assign(static_cast<std::size_t>(rows) * columns, 0.0f);
    previous_ = farthest_;
    empty_ = false;
  }
  newest_ = time;
  if (time - epoch_ > epoch_length) {
    previous_ = farthest_;
    std::fill(farthest_.begin(), farthest_.end(), 0.0f);
    epoch_ = time;
  }
  for (const Eigen::Vector3f& p : scan.points) {
    if (!is_return(p)) continue;
    float& far = farthest_[cell(p)];
    far = std::max(far, p.norm());
  }
}

bool Background::known() const {
  return !empty_ && newest_ - first_ > first_look;
}

double Background::before(const Scan& scan, std::span<const std::uint32_t> returns) const {
  if (!known() || returns.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::size_t before = 0;
  for (const std::uint32_t i : returns) {
    const std::size_t at = cell(scan.points[i]);
    const float far = std::max(farthest_[at], previous_[at]);
    const float range = scan.points[i].norm();
    // Nothing came back from there before: the sky, or something black.
    before += far == 0 || range < 0.95f * far - 0.15f;
  }
  return static_cast<double>(before) / static_cast<double>(returns.size());
}

}  // namespace ca2
