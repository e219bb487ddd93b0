#include "core/solve/lidar_returns.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ca2 {
namespace {

/// Returns further than this from the plane of their own board tell nothing about systematic errors, m.
double own_gate(double sigma) {
  return 0.01 + 5 * sigma;
}

/// Returns further than this from the predicted plane are not of the board, m.
double gate(const LidarSight& sight, const Pose& T_lidar_board, double sigma) {
  // How far the plane may lie from the prediction beyond the returns' noise.
  const double slack = std::min(0.05, std::abs(board_plane(T_lidar_board).distance(sight.center)));
  return 0.01 + 4.5 * sigma + slack;
}

/// A beam is a few milliradians wide: nearer to the rim than this it sees past the board.
double margin(const Pose& T_lidar_board) {
  return 0.004 + 0.003 * T_lidar_board.t.norm();
}

}  // namespace

LidarReturns::LidarReturns(const std::vector<ViewSights>& views, std::size_t lidar,
                           const std::vector<std::vector<int>>& chosen, const InkMap& ink)
    : sights_(views.size(), nullptr), patches_(views.size()) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    const int hypothesis = chosen[v][lidar];
    if (hypothesis < 0) continue;
    sights_[v] = &views[v].lidars[lidar][static_cast<std::size_t>(hypothesis)];
    patches_[v].emplace(*sights_[v], ink);
  }
}

RangeSums LidarReturns::as_found(std::size_t view) {
  RangeSums sums;
  const LidarSight& sight = *sights_[view];
  patches_[view]->fit_found(sight.plane, std::max(5 * sight.rms, 0.005), &sums);
  return sums;
}

void LidarReturns::number_rings(const std::vector<PlacedBoard>& boards) {
  std::optional<int> highest = -1;
  for (const PlacedBoard& board : boards) {
    const std::optional<int> here = patches_[board.view]->highest_ring();
    highest = here && highest ? std::optional(std::max(*here, *highest)) : std::nullopt;
  }
  classes_.rings = highest ? *highest + 1 : 0;
}

void LidarReturns::correct(const std::vector<PlacedBoard>& boards, const RangeState& state) {
  std::vector<CorrectionEvidence> evidence;
  for (const PlacedBoard& board : boards) {
    const ReturnPatch& patch = *patches_[board.view];
    if (patch.count() < 10) continue;
    const Plane own = patch.fit_plane(board_plane(board.T_lidar_board),
                                      gate(*sights_[board.view], board.T_lidar_board, state.sigma));
    evidence.push_back(patch.evidence(own, own_gate(state.sigma)));
  }
  correction_ = estimate_range_correction(classes_, evidence, state.sigma);
  for (const PlacedBoard& board : boards) patches_[board.view]->correct(correction_);
  corrected_sigma_ = state.sigma;
}

std::vector<std::optional<RangeSums>> LidarReturns::by_ray(const std::vector<PlacedBoard>& boards,
                                                           const RangeState& state) {
  std::size_t moved = 0;
  std::vector<std::size_t> views;
  for (const PlacedBoard& board : boards) {
    const double least =
        std::min(gate(*sights_[board.view], board.T_lidar_board, state.sigma), own_gate(state.sigma));
    if (patches_[board.view]->aim(board.outline, board.T_lidar_board, margin(board.T_lidar_board), state.bias,
                                  least)) {
      patches_[board.view]->correct(correction_);
      ++moved;
    }
    views.push_back(board.view);
  }
  const bool others = views != corrected_;
  if (others || moved > 0) number_rings(boards);
  if (others || 4 * moved > boards.size() || std::abs(state.sigma - corrected_sigma_) > 0.05 * state.sigma)
    correct(boards, state);
  corrected_ = std::move(views);
  std::vector<std::optional<RangeSums>> all;
  for (const PlacedBoard& board : boards) {
    all.emplace_back(
        patches_[board.view]->sums(board_plane(board.T_lidar_board), state.bias,
                                   gate(*sights_[board.view], board.T_lidar_board, state.sigma)));
    if (all.back()->weight < 4) all.back().reset();
  }
  return all;
}

}  // namespace ca2
