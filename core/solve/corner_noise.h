/// @file How wrong corners really are, from what is left over after a fit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/solve/corner_field.h"

namespace ca2 {

/// By corner id: the ids above it of the corners closer than some distance.
using NeighbourTable = std::vector<std::vector<int>>;
/// `positions` and `distance` in m.
NeighbourTable neighbouring_corners(std::span<const Eigen::Vector2d> positions, double distance);

/// Collects one camera's reprojection residuals. Independent noise of the size the corners' covariances claim
/// gives a scale of 1. Residuals that neighbours on the board share (a lens the model does not quite fit, a
/// board that is not quite flat) are worth less than their number says: the scale grows with their
/// correlation.
class CornerNoise {
 public:
  /// `errors` [2 x corners]: whitened by the stated covariances, about the view's own best pose: what another
  /// board pose would take away is the LiDAR's pull, not the corners' error.
  void add_view(const CornerField& corners, const Eigen::Matrix2Xd& errors, const NeighbourTable& neighbours);

  /// Factor on the corners' standard deviations; nothing from too few residuals to tell.
  std::optional<double> scale() const;

 private:
  std::vector<double> squares_;  ///< whitened squared errors, 2 degrees of freedom each
  double views_ = 0;
  double products_ = 0;  ///< of whitened errors of neighbours
  double energy_ = 0;    ///< of the same corners
  double pairs_ = 0;
};

}  // namespace ca2
