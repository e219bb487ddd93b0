#include "core/lidar/planar_regions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "core/lidar/plane_sums.h"

namespace ca2 {
namespace {

// Claims on a cell: at kClosed it starts no further region; kWall says why.
constexpr std::uint8_t kClosed = 2, kWall = 3;
constexpr std::uint32_t kMostStamps = 0xf0000000;
constexpr float kLeastJump = 0.06f;  // m, between the board and what is behind it

/// The largest power of two that is not over x; 1 below that. Powers of two
/// keep the lattices of near and far surfaces nested, so that a surface visited
/// coarsely is not visited again by finer seeds.
int power_of_two_below(float x) {
  constexpr int kMantissa = 23, kBias = 127;
  const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(std::max(x, 1.0f)) >> kMantissa) - kBias;
  return 1 << std::min(exponent, 6);
}

class RegionGrower {
 public:
  RegionGrower(const RingImage& image, float width, float height, RegionMemory& memory)
      : image_(image),
        memory_(memory),
        short_side_(std::min(width, height)),
        diagonal_(std::hypot(width, height)),
        board_area_(width * height) {
    for (const float slope : image.slope) cosine_.push_back(1 / std::sqrt(1 + slope * slope));
    memory_.claims.assign(image.range.size(), 0);
    if (memory_.stamps.size() != image.range.size() || memory_.stamp > kMostStamps) {
      memory_.stamps.assign(image.range.size(), 0);
      memory_.stamp = 0;
    }
  }

  PlanarRegions run() {
    PlanarRegions out;
    out.noise = estimate_noise();
    noise_ = out.noise;
    jump_ = std::max(kLeastJump, 5 * noise_);
    longest_ = 1.6f * diagonal_;
    find_ring_runs(image_, {jump_, 0.25f * short_side_, longest_}, memory_.runs);
    for (const RingRun& run : memory_.runs) {
      for (int place = run.first; place <= run.last; ++place) {
        const int row = run.row, column = image_.wrap(place);
        const std::size_t i = image_.index(row, column);
        if (memory_.claims[i] >= kClosed || !on_seed_lattice(row, column, image_.range[i])) continue;
        if (!ends_above_and_below(row, column)) continue;
        const auto seed = fit_seed(row, column);
        if (!seed || seed->rms > 1.6f * noise_ + 0.004f) continue;
        if (auto region = grow(row, column, *seed)) out.regions.push_back(*std::move(region));
      }
    }
    return out;
  }

 private:
  float row_gap(int row, float range) const {
    return range * image_.row_angle[static_cast<std::size_t>(row)];
  }
  float column_gap(float range) const { return range * image_.column_angle; }

  bool on_seed_lattice(int row, int column, float range) const {
    // Too far for two rings and a handful of returns on the board.
    if (range == 0 || row_gap(row, range) > diagonal_ || column_gap(range) > 0.2f * diagonal_) return false;
    const int rows = power_of_two_below(0.25f * short_side_ / row_gap(row, range));
    const int columns = power_of_two_below(0.25f * short_side_ / column_gap(range));
    return (row & (rows - 1)) == 0 && (column & (columns - 1)) == 0;
  }

  /// Does the surface end within the board's size up and down, too? As RingWalk
  /// asks along a ring.
  bool ends_above_and_below(int row, int column) const {
    const float start = image_.range[image_.index(row, column)];
    float extent = 0;
    for (const int way : {-1, 1}) {
      float last = start;
      for (int r = row + way; r >= 0 && r < image_.rows; r += way) {
        const float range = image_.range[image_.index(r, column)];
        if (range == 0) break;
        const float step = range * image_.row_angle[static_cast<std::size_t>(way > 0 ? r - 1 : r)];
        if (std::abs(range - last) > std::max(jump_, kSteep * step)) break;
        extent += step;
        last = range;
      }
    }
    return extent < longest_;
  }

  /// A plane through the surroundings of a cell, as far as the board's short
  /// side allows. Where rings lie far apart the patch is the cell's ring and
  /// the one above.
  std::optional<PlaneSums::Fit> fit_seed(int row, int column) const {
    const Eigen::Vector3f& centre = image_.point(image_.index(row, column));
    const float range = image_.range[image_.index(row, column)], reach = 0.3f * short_side_;
    // As many as an int holds, however near the return and large the board.
    const auto within = [&](float gap) { return static_cast<int>(std::min(reach / gap, 1e6f)); };
    const int rows = within(row_gap(row, range));
    const int below = std::min(row, rows);
    const int above = std::min(image_.rows - 1 - row, std::max(1, rows));
    const int half = std::clamp(within(column_gap(range)), 2, image_.columns / 8);
    const int row_step = std::max(1, (below + above) / 6), column_step = std::max(1, half / 5);
    const float limit = (3 * reach) * (3 * reach);  // of a surface at 70 degrees of incidence
    PlaneSums sums(centre);
    int cells = 0;
    for (int r = row - below; r <= row + above; r += row_step) {
      for (int c = column - half; c <= column + half; c += column_step) {
        ++cells;
        const std::size_t i = image_.index(r, image_.wrap(c));
        if (image_.range[i] > 0 && (image_.point(i) - centre).squaredNorm() < limit)
          sums.add(image_.point(i));
      }
    }
    if (sums.count() < 6 || sums.count() * 4 < cells * 3) return std::nullopt;
    const PlaneSums::Fit fit = sums.fit();
    if (fit.thinness < 0.05f) return std::nullopt;
    return fit;
  }

  /// Most of what a LiDAR sees is smooth: the middle one of the patches'
  /// residuals is noise alone.
  float estimate_noise() const {
    std::vector<float> rms;
    const int row_step = std::max(1, image_.rows / 12), column_step = std::max(1, image_.columns / 24);
    for (int row = 0; row < image_.rows; row += row_step) {
      for (int column = 0; column < image_.columns; column += column_step) {
        const float range = image_.range[image_.index(row, column)];
        if (range == 0 || row_gap(row, range) > diagonal_) continue;
        const auto fit = fit_seed(row, column);
        // Noise lies along the ray; grazing patches say little about it.
        if (fit && fit->offset > 0.3f * range) rms.push_back(fit->rms * range / fit->offset);
      }
    }
    if (rms.empty()) return 0.02f;
    const auto middle = rms.begin() + static_cast<std::ptrdiff_t>(rms.size() / 2);
    std::nth_element(rms.begin(), middle, rms.end());
    return std::clamp(*middle, 0.003f, 0.025f);
  }

  /// Flood fill of one plane on the lattice; none when it is a wall, or nothing
  /// near the board's size.
  std::optional<PlanarRegion> grow(int seed_row, int seed_column, const PlaneSums::Fit& seed) {
    ++memory_.stamp;
    PlaneSums::Fit plane = seed;
    const Eigen::Vector3f start = image_.point(image_.index(seed_row, seed_column));
    const float reach = diagonal_ * diagonal_ * 1.1f;
    // The same to both sides of the plane; returns on a grazing surface scatter
    // less across it.
    const float band = std::clamp(3.5f * noise_ * std::max(0.4f, plane.offset / start.norm()), 0.02f, 0.08f);
    PlaneSums sums(start);
    PlanarRegion region;
    float far_area = 0;
    std::size_t refit_at = 24, on_walls = 0;
    bool wall = false;
    memory_.queue.clear();
    memory_.members.clear();
    push(seed_row, seed_column);
    for (std::size_t next = 0; next < memory_.queue.size(); ++next) {
      const auto [row, column] = memory_.queue[next];
      const std::size_t i = image_.index(row, column);
      const Eigen::Vector3f& p = image_.point(i);
      if (std::abs(plane.normal.dot(p) + plane.offset) > band) continue;
      on_walls += memory_.claims[i] == kWall;
      memory_.members.push_back(static_cast<std::uint32_t>(i));
      const float range = image_.range[i];
      const int rows = row_step(row, range), columns = column_step(range);
      const float facing = std::max(0.1f, plane.offset / range);  // cosine of the incidence
      const float area = row_gap(row, range) * static_cast<float>(rows) * column_gap(range) *
                         static_cast<float>(columns) * cosine_[static_cast<std::size_t>(row)] / facing;
      // Hands and arms may lead on to the body along the plane: what is farther
      // away than any part of the board counts apart, and does not bend the
      // plane.
      if ((p - start).squaredNorm() > reach) {
        far_area += area;
      } else {
        region.area += area;
        region.cells.push_back(static_cast<std::uint32_t>(i));
        sums.add(p);
      }
      if (memory_.members.size() == refit_at) {
        if (sums.count() >= 12) plane = sums.fit();
        refit_at *= 2;
      }
      wall = region.area > 2.2f * board_area_ || far_area > 3 * board_area_ ||
             (memory_.members.size() >= 32 && on_walls * 5 > memory_.members.size() * 3);
      if (wall) break;
      visit(row, column - columns);
      visit(row, column + columns);
      visit(row - rows, column);
      visit(row + rows, column);
    }
    const bool fits = !wall && region.area > 0.3f * board_area_;
    for (const std::uint32_t i : memory_.members) {
      const std::uint8_t claim =
          wall   ? kWall
          : fits ? kClosed
                 : static_cast<std::uint8_t>(std::min(memory_.claims[i] + 1, int{kClosed}));
      memory_.claims[i] = std::max(memory_.claims[i], claim);
    }
    if (!fits) return std::nullopt;
    plane = sums.fit();
    region.plane = {plane.normal.cast<double>().normalized(), plane.offset};
    return region;
  }

  int row_step(int row, float range) const {
    return power_of_two_below(0.125f * short_side_ / row_gap(row, range));
  }
  int column_step(float range) const { return power_of_two_below(0.125f * short_side_ / column_gap(range)); }

  void visit(int row, int column) {
    if (row < 0 || row >= image_.rows) return;
    column = image_.wrap(column);
    const float range = image_.range[image_.index(row, column)];
    if (range == 0) return;
    // Back on the lattice of this cell's own range.
    push(row & ~(row_step(row, range) - 1), column & ~(column_step(range) - 1));
  }

  void push(int row, int column) {
    const std::size_t i = image_.index(row, column);
    if (image_.range[i] == 0 || memory_.stamps[i] == memory_.stamp) return;
    memory_.stamps[i] = memory_.stamp;
    memory_.queue.push_back({row, column});
  }

  const RingImage& image_;
  RegionMemory& memory_;
  float short_side_, diagonal_, board_area_, noise_ = 0;
  float jump_ = 0, longest_ = 0;  ///< m, of runs
  std::vector<float> cosine_;     ///< [row] of the elevation
};

}  // namespace

PlanarRegions find_planar_regions(const RingImage& image, double width, double height, RegionMemory& memory) {
  return RegionGrower(image, static_cast<float>(width), static_cast<float>(height), memory).run();
}

}  // namespace ca2
