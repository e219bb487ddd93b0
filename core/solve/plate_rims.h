/// @file The plates' rims as the LiDARs of a rig saw them: where each should be, how well it is known, its
/// sums.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/solve/edge_noise.h"
#include "core/solve/edge_sums.h"
#include "core/solve/joint_problem.h"
#include "core/solve/rim_residuals.h"

namespace ca2 {

/// m: rims of LiDARs that planes placed well are within this. Nearer ones tell how they err.
inline constexpr double usual_rim_slack = 0.06;
/// m: what they are looked for within at last.
inline constexpr double final_rim_slack = 0.01;
/// Where planes leave the LiDARs' places open to no more than this, m, there is nothing to approach step by
/// step.
inline constexpr double sure_place_sigma = final_rim_slack / 6;

class PlateRims {
 public:
  /// `chosen` [view][lidar]: the hypothesis that is the board; negative: none. Board, views and choice must
  /// live as long. In all that follows `state` has a board per view, and `used` are indices of views.
  PlateRims(const Board& board, const std::vector<ViewSights>& views,
            const std::vector<std::vector<int>>& chosen, std::size_t lidars);

  bool any(std::span<const std::size_t> used) const;
  /// What to look within, solve after solve, where planes left the LiDARs' places open to `place_sigma` [m]:
  /// at first as far as that may have put them off, up to half the plate.
  std::vector<double> slacks(double place_sigma) const;
  /// How far a rim may lie from where it is predicted, m; 0, as at first: rims are not used.
  void look_within(double slack) { slack_ = slack; }
  bool in_use() const { return slack_ > 0; }

  /// About a pattern whose ids may start at either end; until rims told from which, what is plate either way.
  const Outline& outline(std::size_t view) const { return outlines_[view]; }
  /// Where the plate's centre is not the pattern's, the rims tell from which end the corners were counted; a
  /// view whose rims do not has none.
  void settle_half_turns(const JointState& state, std::span<const std::size_t> used);

  /// From now on nobody is taken to tell where rims are better than so.
  void expect_at_least(const EdgeNoise& noise) { least_ = noise; }
  /// Finds out how well the LiDARs tell where rims are; what only few of them could say is left as it is.
  void estimate_blur(const JointState& state, std::span<const std::size_t> used);
  void estimate_errors(const JointState& state, std::span<const std::size_t> used);
  const std::vector<EdgeNoise>& noise() const { return noise_; }  ///< by LiDAR

  /// By LiDAR, m: JointAnswer::outline_offset.
  std::vector<double> center_offsets(const JointState& state, std::span<const std::size_t> used) const;
  /// By LiDAR: see `lens_gain`, for lenses `radii` [m] in front of the axes; 0 where that is 0.
  std::vector<double> lens_gains(const JointState& state, std::span<const std::size_t> used,
                                 const RimFreedom& free, std::span<const double> radii) const;

  /// Of one view's sides; empty where LiDAR `lidar` saw none.
  std::vector<EdgeSums> sums(const JointState& state, std::size_t view, std::size_t lidar) const;

 private:
  bool settled(std::size_t view) const;
  std::span<const EdgeCrossing> crossings(std::size_t view, std::size_t lidar) const;
  std::optional<EdgeView> seen(const JointState& state, std::size_t view, std::size_t lidar) const;
  std::vector<EdgeView> all_seen(const JointState& state, std::span<const std::size_t> used,
                                 std::size_t lidar) const;

  const Board& board_;
  const std::vector<ViewSights>& views_;
  const std::vector<std::vector<int>>& chosen_;
  bool either_way_;  ///< the plate's centre is not the pattern's, whose ids may start at either end
  std::vector<Outline> outlines_;       ///< by view
  std::vector<EdgeNoise> noise_;        ///< by LiDAR
  mutable std::vector<RimMemo> memos_;  ///< by view, then LiDAR; they change no answer
  double slack_ = 0;                    ///< m
  EdgeNoise least_;                     ///< see expect_at_least
};

}  // namespace ca2
