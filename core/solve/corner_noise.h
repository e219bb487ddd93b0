/// @file How wrong corners really are, from what is left over after a fit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"

namespace ca2 {

/// Collects one camera's reprojection residuals. Independent noise of the size the corners' covariances claim
/// gives a scale of 1. Residuals that neighbours on the board share (a lens the model does not quite fit, a
/// board that is not quite flat) are worth less than their number says: the scale grows with their
/// correlation.
class CornerNoise {
 public:
  /// Returns the view's reprojection error, px rms. `positions`: of the board's corners by id, board frame,
  /// m.
  double add_view(const Board& board, std::span<const Eigen::Vector2d> positions, const Camera& camera,
                  const Pose& T_camera_board, std::span<const Corner> corners);

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
