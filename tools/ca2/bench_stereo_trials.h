/// @file The protocol of `ca2 bench stereo`: two cameras calibrated to one LiDAR apart, and the baseline that
/// follows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/features/sights.h"
#include "core/session/rig.h"
#include "core/types/result.h"

namespace ca2 {

/// Views of which subsets are drawn.
struct StereoPool {
  Rig rig;                        ///< as stated; its first two cameras, by name, and its first LiDAR count
  std::vector<ViewSights> views;  ///< sensors in the rig's order
  /// Of cameras whose intrinsics were estimated from the views, see CalibrateOptions.
  std::map<std::string, Eigen::VectorXd> estimated;
  Pose T_left_right;  ///< the baseline as known: what answers are compared with
};

/// Keeps two cameras, one LiDAR and the views in which all three see the board. What the rig says of where
/// its sensors are is forgotten. ErrorCode::config when there are fewer sensors.
Result<void> keep_stereo(StereoPool& pool);

/// One method's errors.
struct StereoErrors {
  std::vector<double> translation;  ///< m, by subset
  std::vector<double> rotation;     ///< rad
};

inline constexpr std::array stereo_methods{"kim", "plane_to_plane", "joint", "joint with edges",
                                           "all at once"};

/// One number of views.
struct StereoCell {
  int views = 0;
  int subsets = 0;                                         ///< that count
  std::array<StereoErrors, stereo_methods.size()> errors;  ///< in the order of stereo_methods
};

/// Calibrates one subset of `cell.views` views, drawn at random, by every method: each camera alone with the
/// LiDAR, whose two answers give the baseline, and all three at once. A subset that a method refuses is left
/// out for all.
void try_subset(const StereoPool& pool, std::mt19937_64& rng, StereoCell& cell);

/// The baseline that all views give at once; for pools whose baseline nobody knows.
Result<Pose> baseline_of_all(const StereoPool& pool);

}  // namespace ca2
