#include "core/capture/background.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lidar/scan_grid.h"
#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

constexpr int columns = 360;         // a degree: every revolution of every LiDAR meets each
constexpr float row_step = 0.0175f;  // rad: a degree, too; beams farther apart leave rows empty
constexpr int rows = 180;            // over all elevations
constexpr std::int64_t epoch_length = 30'000'000'000;  // ns
constexpr std::int64_t first_look = 1'000'000'000;     // ns
constexpr std::int64_t least_gap = 150'000'000;        // ns: more scans tell nothing more
constexpr std::size_t points_at_once = 512;

/// The cells of points' directions; `across`: m, their distances from the z axis.
CA2_HOT_LOOP void find_cells(std::size_t size, const float* __restrict points, const float* __restrict across,
                             std::uint32_t* __restrict cells) {
  constexpr float pi = std::numbers::pi_v<float>;
  for (std::size_t i = 0; i < size; ++i) {
    const float column = (fast_azimuth(points[3 * i], points[3 * i + 1]) + pi) * (columns / (2 * pi));
    const float row = (fast_azimuth(across[i], points[3 * i + 2]) + pi / 2) * (1 / row_step);
    cells[i] = static_cast<std::uint32_t>(row < rows - 1 ? row : rows - 1) * columns +
               static_cast<std::uint32_t>(column < columns - 1 ? column : columns - 1);
  }
}

/// Of a scan's points, some at a time, with the cells they fall in.
class Cells {
 public:
  /// At most points_at_once.
  void find(std::span<const Eigen::Vector3f> points) {
    for (std::size_t i = 0; i < points.size(); ++i) across_[i] = points[i].head<2>().norm();
    find_cells(points.size(), points.front().data(), across_, cells_);
  }
  std::uint32_t operator[](std::size_t i) const { return cells_[i]; }

 private:
  float across_[points_at_once];
  std::uint32_t cells_[points_at_once];
};

}  // namespace

void Background::add(const Scan& scan, std::int64_t time) {
  if (empty_ || time < newest_) {  // the first scan, or the clock was set back
    first_ = epoch_ = time;
    farthest_.assign(static_cast<std::size_t>(rows) * columns, 0.0f);
    previous_ = farthest_;
    empty_ = false;
  } else if (time - newest_ < least_gap) {
    return;
  }
  newest_ = time;
  if (time - epoch_ > epoch_length) {
    previous_ = farthest_;
    std::fill(farthest_.begin(), farthest_.end(), 0.0f);
    epoch_ = time;
  }
  Cells cells;
  for (std::size_t first = 0; first < scan.size(); first += points_at_once) {
    const auto points = std::span(scan.points).subspan(first, std::min(points_at_once, scan.size() - first));
    cells.find(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float square = points[i].squaredNorm();
      if (!is_return(square)) continue;
      float& farthest = farthest_[cells[i]];
      farthest = std::max(farthest, square);
    }
  }
}

bool Background::known() const {
  return !empty_ && newest_ - first_ > first_look;
}

double Background::before(const Scan& scan, std::span<const std::uint32_t> returns) const {
  if (!known() || returns.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::size_t before = 0;
  Cells cells;
  for (const std::uint32_t i : returns) {
    cells.find(std::span(&scan.points[i], 1));
    const float far = std::sqrt(std::max(farthest_[cells[0]], previous_[cells[0]]));
    const float range = scan.points[i].norm();
    // Nothing came back from there before: the sky, or something black.
    before += far == 0 || range < 0.95f * far - 0.15f;
  }
  return static_cast<double>(before) / static_cast<double>(returns.size());
}

}  // namespace ca2
