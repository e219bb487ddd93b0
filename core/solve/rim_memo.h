/// @file The last edge sums of a rim: what asks how wrong rims are and what solves with them ask for the
/// same.
#pragma once

#include <optional>
#include <vector>

#include "core/solve/edge_sums.h"

namespace ca2 {

/// Of one rim, whose crossings never change.
class RimMemo {
 public:
  /// `edge_sums` of these, or those made for a place a hair's breadth beside. Of the noise only the blur has
  /// more than a small part in them.
  std::vector<EdgeSums> sums(std::span<const EdgeCrossing> crossings, const Outline& outline,
                             const Pose& T_lidar_board, const Dilation& dilation, const EdgeNoise& noise,
                             double slack);

 private:
  struct Key {
    Eigen::Vector2d size, center;
    Pose T_lidar_board;
    Dilation dilation;
    double blur, slack;
    bool good_for(const Key& other) const;
  };
  std::optional<Key> key_;
  std::vector<EdgeSums> sums_;  ///< without an error that is shared
};

}  // namespace ca2
