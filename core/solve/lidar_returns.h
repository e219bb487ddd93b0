/// @file All of one LiDAR's returns of the boards, reduced to sums view by view.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/geometry/pose.h"
#include "core/solve/range_correction.h"
#include "core/solve/range_sums.h"
#include "core/solve/return_patch.h"

namespace ca2 {

/// What is known when the returns are to be reduced.
struct RangeState {
  double bias = 0;   ///< of the LiDAR's ranges, m
  double sigma = 0;  ///< noise of one return, m
};

/// Where a board is held to be while its returns are chosen.
struct PlacedBoard {
  std::size_t view = 0;  ///< index into the views
  Outline outline;
  Pose T_lidar_board;
};

class LidarReturns {
 public:
  /// `chosen` [view][lidar]: the hypothesis that is the board; negative: none. The views and the print must
  /// live as long.
  LidarReturns(const std::vector<ViewSights>& views, std::size_t lidar,
               const std::vector<std::vector<int>>& chosen, const InkMap& ink);

  bool sees(std::size_t view) const { return sights_[view] != nullptr; }

  /// The sums of the returns the finder held for the board.
  RangeSums as_found(std::size_t view);
  /// The sums of the returns whose rays meet the boards, systematic errors taken out; by board, nothing where
  /// too few are left. Only boards in views that the LiDAR saw.
  std::vector<std::optional<RangeSums>> by_ray(const std::vector<PlacedBoard>& boards,
                                               const RangeState& state);
  /// Of the systematic errors taken out by `by_ray`.
  double slope_sigma() const { return correction_.slope_sigma; }

 private:
  void number_rings(const std::vector<PlacedBoard>& boards);
  void correct(const std::vector<PlacedBoard>& boards, const RangeState& state);

  std::vector<const LidarSight*> sights_;            ///< by view
  std::vector<std::optional<ReturnPatch>> patches_;  ///< by view
  RangeClasses classes_;
  RangeCorrection correction_;
  double corrected_sigma_ = 0;
  std::vector<std::size_t> corrected_;  ///< the views it was found in
};

}  // namespace ca2
