/// @file From nothing to a camera that fits its views: focal hypotheses, then robust rounds of the
/// adjustment.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/intrinsics/intrinsics_bundle.h"

namespace ca2 {

/// A value: copied to try another start. References the board and the corners.
class IntrinsicsFit {
 public:
  /// `camera`: model and picture size.
  IntrinsicsFit(const Board& board, std::span<const std::vector<Corner>> corners, const Camera& camera);

  /// Tries fields of view from tele lens to fisheye with the model's parameters behind fx fy cx cy at
  /// `shape`, on a dozen views: how well single boards fit sorts them, a short adjustment of the best three
  /// decides. False when no field of view lets a board be placed.
  bool seed(const CameraParameters& shape);

  /// Adjusts everything; sets aside views and corners that disagree, and takes back those that no longer do,
  /// until nothing changes. False when that does not settle or fewer than `min_views` agree.
  bool settle(int min_views);

  /// Sum of squared whitened errors of all views' corners, each at most that of `limit`: to compare two fits.
  double misfit(double limit) const;

  int used_views() const;
  /// Corners that take part, px.
  std::vector<Eigen::Vector2d> pixels() const;
  /// Boards of the used views, T_camera_board.
  std::vector<Pose> poses() const;

  IntrinsicsBundle::State state;
  std::vector<BundleView> views;
  std::vector<std::string> reasons;  ///< by view: why it is not used; empty when it is
  double noise = 1;                  ///< of the corners relative to their covariances, blind to outliers

  /// Where Huber's cost turns linear and where a corner is wrong (once in 250 000 good ones), in `noise`.
  static constexpr double huber_sigmas = 3;
  static constexpr double corner_sigmas = 5;

 private:
  bool hypothesis(double field_of_view, const CameraParameters& shape, Camera& camera) const;
  double place_boards(IntrinsicsBundle::State& placed, std::vector<BundleView>& of) const;
  bool classify();

  const Board& board_;
  std::span<const std::vector<Corner>> corners_;
  std::vector<bool> usable_;  ///< by view: enough corners
};

}  // namespace ca2
