/// @file How well a LiDAR tells where rims are, from what its crossings themselves show.
#pragma once

#include <span>

#include "core/solve/edge_sums.h"

namespace ca2 {

/// The crossings of one view, and about where the plate is.
struct EdgeView {
  std::span<const EdgeCrossing> crossings;
  Outline outline;
  Pose T_lidar_board;
};

/// The blur [rad] with which straight rims are possible; 0 where the rays' gaps alone make them so. `slack`
/// as for `edge_sums`.
double estimate_edge_blur(std::span<const EdgeView> views, double dilation, double slack);

/// Chi-squared of the crossings with the plate where it is.
double edge_misfit(const EdgeView& view, double dilation, const EdgeNoise& noise, double slack);

/// How far the plates' centres, as their rims show them, are from where they are held to be: rms, in the
/// plane, m; NaN where no rim tells.
double mean_center_offset(std::span<const EdgeView> views, double dilation, const EdgeNoise& noise,
                          double slack);

/// The error [m] that the crossings of one side share, under which the sides lie off the views' poses no more
/// than they should; 0.1 mm at least.
double estimate_shared_edge_error(std::span<const EdgeView> views, double dilation, double blur,
                                  double slack);

}  // namespace ca2
