#include "core/solve/plate_rims.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/solve/lens_evidence.h"

namespace ca2 {
namespace {

/// Two ways of placing the plate about the pattern, where nobody knows which end is which.
bool either_way(const Board& board) {
  return board.type->half_turn_ambiguous(board) && !board.extent().center.isZero();
}

/// Chi-squared by which rims must prefer one way.
constexpr double convincing_gain = 20;

/// What is plate either way: the pattern at least.
Outline common_part(Outline plate) {
  plate.width = std::max(0.0, plate.width - 2 * std::abs(plate.center.x()));
  plate.height = std::max(0.0, plate.height - 2 * std::abs(plate.center.y()));
  plate.center.setZero();
  return plate;
}

}  // namespace

PlateRims::PlateRims(const Board& board, const std::vector<ViewSights>& views,
                     const std::vector<std::vector<int>>& chosen, std::size_t lidars)
    : board_(board),
      views_(views),
      chosen_(chosen),
      either_way_(either_way(board)),
      outlines_(views.size(), either_way_ ? common_part(board.extent()) : board.extent()),
      noise_(lidars),
      memos_(views.size() * lidars) {}

bool PlateRims::any(std::span<const std::size_t> used) const {
  for (const std::size_t v : used) {
    for (std::size_t l = 0; l < noise_.size(); ++l) {
      if (!crossings(v, l).empty()) return true;
    }
  }
  return false;
}

std::vector<double> PlateRims::slacks(double place_sigma) const {
  const Outline plate = board_.extent();
  const double reach = std::min(3 * place_sigma, 0.5 * std::min(plate.width, plate.height));
  std::vector<double> list{usual_rim_slack, 0.025, final_rim_slack};
  if (place_sigma < sure_place_sigma) list.erase(list.begin() + 1);
  while (list.front() < reach) list.insert(list.begin(), 2 * list.front());
  return list;
}

std::span<const EdgeCrossing> PlateRims::crossings(std::size_t view, std::size_t lidar) const {
  const int hypothesis = chosen_[view][lidar];
  if (hypothesis < 0) return {};
  return views_[view].lidars[lidar][static_cast<std::size_t>(hypothesis)].crossings;
}

std::optional<EdgeView> PlateRims::seen(const JointState& state, std::size_t view, std::size_t lidar) const {
  const std::span<const EdgeCrossing> list = crossings(view, lidar);
  if (list.empty()) return std::nullopt;
  Pose T_lidar_rim = state.T_ref_lidar[lidar].inverse() * state.T_ref_board[view];
  T_lidar_rim.t += state.rim_depth * T_lidar_rim.R.col(2);
  return EdgeView{list, outlines_[view], T_lidar_rim, &memos_[view * noise_.size() + lidar]};
}

std::vector<EdgeView> PlateRims::all_seen(const JointState& state, std::span<const std::size_t> used,
                                          std::size_t lidar) const {
  std::vector<EdgeView> list;
  for (const std::size_t v : used) {
    if (!settled(v)) continue;
    if (const auto view = seen(state, v, lidar)) list.push_back(*view);
  }
  return list;
}

bool PlateRims::settled(std::size_t view) const {
  return !either_way_ || !outlines_[view].center.isZero();
}

void PlateRims::settle_half_turns(const JointState& state, std::span<const std::size_t> used) {
  if (!either_way_) return;
  const Outline stated = board_.extent();
  // Rims must not be out of reach just because the plate was thought to be the other way round.
  const double slack = slack_ + 2 * stated.center.norm();
  for (const std::size_t v : used) {
    double gain = 0;  // of the plate turned
    for (std::size_t l = 0; l < noise_.size(); ++l) {
      std::optional<EdgeView> view = seen(state, v, l);
      if (!view) continue;
      view->outline = stated;
      gain += edge_misfit(*view, state.dilation[l], noise_[l], slack);
      view->outline.center = -stated.center;
      gain -= edge_misfit(*view, state.dilation[l], noise_[l], slack);
    }
    if (std::abs(gain) < convincing_gain) continue;
    outlines_[v] = stated;
    if (gain > 0) outlines_[v].center = -stated.center;
  }
}

void PlateRims::estimate_blur(const JointState& state, std::span<const std::size_t> used) {
  for (std::size_t l = 0; l < noise_.size(); ++l) {
    const std::vector<EdgeView> views = all_seen(state, used, l);
    if (!views.empty())
      noise_[l].blur = std::max(least_.blur, estimate_edge_blur(views, state.dilation[l], slack_));
  }
}

void PlateRims::estimate_errors(const JointState& state, std::span<const std::size_t> used) {
  for (std::size_t l = 0; l < noise_.size(); ++l) {
    const std::vector<EdgeView> views = all_seen(state, used, l);
    if (views.empty()) continue;
    const double blur = noise_[l].blur;
    noise_[l] = likeliest_errors(rim_residuals(views, state.dilation[l], blur, slack_)).noise;
    noise_[l].blur = blur;
    noise_[l].shared = std::max(noise_[l].shared, least_.shared);
    noise_[l].backdrop = std::max(noise_[l].backdrop, least_.backdrop);
  }
}

std::vector<double> PlateRims::center_offsets(const JointState& state,
                                              std::span<const std::size_t> used) const {
  std::vector<double> offsets;
  for (std::size_t l = 0; l < noise_.size(); ++l) {
    const std::vector<EdgeView> views = all_seen(state, used, l);
    offsets.push_back(views.empty() ? std::numeric_limits<double>::quiet_NaN()
                                    : mean_center_offset(views, state.dilation[l], noise_[l], slack_));
  }
  return offsets;
}

std::vector<double> PlateRims::lens_gains(const JointState& state, std::span<const std::size_t> used,
                                          const RimFreedom& free, std::span<const double> radii) const {
  std::vector<double> gains(noise_.size(), 0);
  for (std::size_t l = 0; l < radii.size(); ++l) {
    if (!(radii[l] > 0)) continue;
    gains[l] = lens_gain(all_seen(state, used, l), state.dilation[l], noise_[l].blur, slack_, free, radii[l]);
  }
  return gains;
}

std::vector<EdgeSums> PlateRims::sums(const JointState& state, std::size_t view, std::size_t lidar) const {
  if (!settled(view)) return {};
  const auto rim = seen(state, view, lidar);
  if (!rim) return {};
  return edge_sums(*rim, state.dilation[lidar], noise_[lidar], slack_);
}

}  // namespace ca2
