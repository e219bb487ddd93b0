#include "core/features/lidar_sights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

constexpr std::size_t returns_at_once = 512;  // most of them are far from the board: passed over together

/// What may be stored of a return's intensity, see BoardReturn: a few white squares and a strip of tape
/// differ by a hundred times at most, and vendors count up to 1, 255 or 65535.
class IntensityScale {
 public:
  IntensityScale(const Scan& scan, const BoardCandidate& candidate) : scan_(scan) {
    if (scan.intensity.size() != scan.size()) return;
    float largest = 0;
    for (const std::uint32_t i : candidate.returns) {
      if (std::isfinite(scan.intensity[i])) largest = std::max(largest, scan.intensity[i]);
    }
    if (largest > 0) scale_ = BoardReturn::full_intensity / largest;
  }

  std::uint16_t of(std::size_t i) const {
    if (!(scale_ > 0) || !(scan_.intensity[i] >= 0)) return BoardReturn::no_intensity;
    return static_cast<std::uint16_t>(
        std::min(scale_ * scan_.intensity[i], static_cast<float>(BoardReturn::full_intensity)));
  }

 private:
  const Scan& scan_;
  float scale_ = 0;
};

/// Rays within an angle of an axis.
struct Cone {
  float x, y, z;  ///< unit
  float cosine;
};

/// Some of a scan's points, coordinate by coordinate.
struct Points {
  std::size_t size = 0;
  float x[returns_at_once], y[returns_at_once], z[returns_at_once];
  float range[returns_at_once];  ///< m
};

CA2_HOT_LOOP void split(std::size_t size, const float* __restrict from, Points& to) {
  to.size = size;
  for (std::size_t i = 0; i < size; ++i) {
    const float x = from[3 * i], y = from[3 * i + 1], z = from[3 * i + 2];
    to.x[i] = x, to.y[i] = y, to.z[i] = z;
    to.range[i] = x * x + (y * y + z * z);
  }
  for (std::size_t i = 0; i < size; ++i) to.range[i] = std::sqrt(to.range[i]);
}

/// Which of the points are within (not 0; what is not finite never is). Is any?
CA2_HOT_LOOP bool mark_within(const Cone& cone, const Points& points, std::int32_t* __restrict within) {
  const float x = cone.x, y = cone.y, z = cone.z, cosine = cone.cosine;
  std::int32_t any = 0;
  for (std::size_t i = 0; i < points.size; ++i) {
    const float along = points.x[i] * x + (points.y[i] * y + points.z[i] * z);
    within[i] = along > cosine * points.range[i] ? 1 : 0;
    any |= within[i];
  }
  return any != 0;
}

/// Gathers the returns on a candidate; and those whose rays pass within a quarter more than the board's
/// half-diagonal of the patch's centre, but for those on a hand: what the choice of returns by ray is made
/// from.
class Gathering {
 public:
  Gathering(const Scan& scan, const BoardCandidate& candidate, const Board& board, LidarSight& sight)
      : scan_(scan),
        candidate_(candidate),
        sight_(sight),
        intensity_(scan, candidate),
        on_board_(candidate.returns) {
    const Outline extent = board.extent();
    const double radius = 1.25 * 0.5 * std::hypot(extent.width, extent.height);
    const double distance = sight.center.norm();
    const Eigen::Vector3f axis = (sight.center / distance).cast<float>();
    cone_ = {axis.x(), axis.y(), axis.z(), static_cast<float>(std::cos(std::atan2(radius, distance)))};
    std::sort(on_board_.begin(), on_board_.end());
    on_board_.push_back(UINT32_MAX);
  }

  /// The scan's returns from `first` on, those that follow what was added before.
  void add(std::size_t first, const Points& points) {
    std::int32_t within[returns_at_once];
    const bool any = mark_within(cone_, points, within);
    const std::size_t end = first + points.size;
    if (!any && on_board_[next_] >= end) return;
    for (std::size_t i = first; i < end; ++i) {
      const bool on = on_board_[next_] == i;
      while (on_board_[next_] == i) ++next_;
      if (on || (within[i - first] != 0 && !covered(i)))
        (on ? sight_.on_board : sight_.around).push_back(of(i));
    }
  }

 private:
  bool covered(std::size_t i) const {
    return std::binary_search(candidate_.covered.begin(), candidate_.covered.end(), i);
  }

  BoardReturn of(std::size_t i) const {
    BoardReturn here{scan_.points[i]};
    if (!scan_.ring.empty()) here.ring = scan_.ring[i];
    const std::size_t beam = candidate_.found_ring ? (*candidate_.found_ring)[i] : here.ring;
    if (beam < candidate_.beam_height.size()) here.height = candidate_.beam_height[beam];
    here.intensity = intensity_.of(i);
    return here;
  }

  const Scan& scan_;
  const BoardCandidate& candidate_;
  LidarSight& sight_;
  IntensityScale intensity_;
  Cone cone_;
  std::vector<std::uint32_t> on_board_;  ///< rising, and an end
  std::size_t next_ = 0;                 ///< in on_board_
};

}  // namespace

std::vector<LidarSight> sights_of(const Scan& scan, const Board& board,
                                  std::span<const BoardCandidate> candidates) {
  std::vector<LidarSight> sights(candidates.size());
  std::vector<Gathering> gatherings;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const BoardCandidate& candidate = candidates[k];
    LidarSight& sight = sights[k];
    sight.plane = candidate.plane;
    sight.center = candidate.T_lidar_board.t;
    sight.crossings = candidate.crossings;
    sight.rms = candidate.rms;
    sight.score = candidate.score;
    gatherings.emplace_back(scan, candidate, board, sight);
  }
  // All candidates' from a few returns, and on: a scan is larger than a cache.
  Points points;
  for (std::size_t first = 0; first < scan.size() && !gatherings.empty(); first += returns_at_once) {
    split(std::min(returns_at_once, scan.size() - first), scan.points[first].data(), points);
    for (Gathering& gathering : gatherings) gathering.add(first, points);
  }
  return sights;
}

std::vector<LidarSight> find_sights(const Scan& scan, const Board& board) {
  return sights_of(scan, board, find_board_candidates(scan, board));
}

Result<LidarSight> picked_sight(const Scan& scan, const Board& board, const Pick& pick) {
  const Result<BoardCandidate> picked = fit_picked_patch(scan, board, pick.row, pick.column, pick.radius);
  if (!picked) return fail(picked.error());
  return sights_of(scan, board, {&*picked, 1}).front();
}

}  // namespace ca2
