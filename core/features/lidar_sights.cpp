#include "core/features/lidar_sights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ca2 {
namespace {

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

/// Returns whose rays pass within a quarter more than the board's half-diagonal of the patch's centre, but
/// for those on a hand: what the choice of returns by ray is made from.
void gather_around(const Scan& scan, const BoardCandidate& candidate, const Board& board, LidarSight& sight) {
  const Outline extent = board.extent();
  const double distance = sight.center.norm();
  const double radius = 1.25 * 0.5 * std::hypot(extent.width, extent.height);
  const double cosine = std::cos(std::atan2(radius, distance));
  const Eigen::Vector3f axis = (sight.center / distance).cast<float>();
  const IntensityScale intensity(scan, candidate);
  std::vector<char> on_board(scan.size(), 0), covered(scan.size(), 0);
  for (const std::uint32_t i : candidate.returns) on_board[i] = 1;
  for (const std::uint32_t i : candidate.covered) covered[i] = 1;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    BoardReturn here{p};
    if (!scan.ring.empty()) here.ring = scan.ring[i];
    const std::size_t beam = candidate.found_ring ? (*candidate.found_ring)[i] : here.ring;
    if (beam < candidate.beam_height.size()) here.height = candidate.beam_height[beam];
    const bool beside =
        !on_board[i] && !covered[i] && p.dot(axis) > static_cast<float>(cosine) * p.norm();  // not for NaN
    if (!on_board[i] && !beside) continue;
    here.intensity = intensity.of(i);
    (beside ? sight.around : sight.on_board).push_back(here);
  }
}

}  // namespace

LidarSight sight_of(const Scan& scan, const Board& board, const BoardCandidate& candidate) {
  LidarSight sight;
  sight.plane = candidate.plane;
  sight.center = candidate.T_lidar_board.t;
  sight.crossings = candidate.crossings;
  sight.rms = candidate.rms;
  sight.score = candidate.score;
  gather_around(scan, candidate, board, sight);
  return sight;
}

std::vector<LidarSight> find_sights(const Scan& scan, const Board& board) {
  std::vector<LidarSight> sights;
  for (const BoardCandidate& candidate : find_board_candidates(scan, board)) {
    sights.push_back(sight_of(scan, board, candidate));
  }
  return sights;
}

Result<LidarSight> picked_sight(const Scan& scan, const Board& board, const Pick& pick) {
  const Result<BoardCandidate> picked = fit_picked_patch(scan, board, pick.row, pick.column, pick.radius);
  if (!picked) return fail(picked.error());
  return sight_of(scan, board, *picked);
}

}  // namespace ca2
