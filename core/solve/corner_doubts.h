/// @file Whether the corners contradict what is taken for granted about them: lenses and print.
#pragma once

#include <vector>

#include "core/solve/corner_noise.h"
#include "core/solve/joint_problem.h"

namespace ca2 {

/// How far off they may be where they are wrong: standard deviations; 0: they are right.
struct DoubtPriors {
  /// px: what a coefficient of the distortion alone moves a corner by where it moves one most. So it means
  /// the same for every model.
  double distortion = 0;
  double stretch = 0;  ///< of the print along x and y, relative: paper and printers
  double size = 0;     ///< the same where the LiDARs contradict it: prints scaled to fit a page
};

/// What cannot be held.
struct CornerDoubts {
  /// By camera: sigma of its distortion's coefficients, in their units; empty where it is believed.
  std::vector<CameraParameters> distortion;
  double stretch = 0;  ///< sigma of the print's; 0: it is believed

  bool any() const;
  /// Makes unknowns of them, with these priors.
  void open(JointInput& input) const;
};

/// A lens is calibrated once for everybody, and its distortion is given to six digits: freeing it costs
/// precision where it is right. So it is believed, and so is the print, until the corners speak against it a
/// thousand to one: the ratio of how probable the views are with and without it (the Bayes factor), with the
/// corners' noise as it is when nothing is believed. Corners only, every view's board pose being its own: a
/// LiDAR's errors make no lens wrong. Cameras whose intrinsics are held are not asked.
///
/// `state`: the minimum under `input`, whose corner scales are up to date. `neighbours`: of the board's
/// corners.
CornerDoubts doubt_corners(const JointInput& input, const JointState& state, const NeighbourTable& neighbours,
                           const DoubtPriors& priors);

}  // namespace ca2
