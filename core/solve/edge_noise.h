/// @file How well a LiDAR tells where rims are, from what its crossings themselves show.
#pragma once

#include <span>

#include "core/solve/edge_sums.h"
#include "core/solve/rim_memo.h"

namespace ca2 {

/// The crossings of one view, and about where the plate is.
struct EdgeView {
  std::span<const EdgeCrossing> crossings;
  Outline outline;
  Pose T_lidar_board;
  RimMemo* memo = nullptr;  ///< of these crossings, where they are looked at more than once
};

/// What the rims of one or two views are off by at least: too few to contradict each other, they seem
/// perfect. About what many views show of simulated LiDARs whose beams are 2 to 6 mrad wide.
inline constexpr EdgeNoise usual_edge_noise{0.0001, 0.0005, 0.0002, 0};

/// `edge_sums` of the view.
std::vector<EdgeSums> edge_sums(const EdgeView& view, const Dilation& dilation, const EdgeNoise& noise,
                                double slack);

/// The blur [rad] with which straight rims are possible; 0 where the rays' gaps alone make them so. `slack`
/// as for `edge_sums`.
double estimate_edge_blur(std::span<const EdgeView> views, const Dilation& dilation, double slack);

/// Chi-squared of the crossings with the plate where it is.
double edge_misfit(const EdgeView& view, const Dilation& dilation, const EdgeNoise& noise, double slack);

/// How far the plates' centres, as their rims show them, are from where they are held to be: rms, in the
/// plane, m; NaN where no rim tells.
double mean_center_offset(std::span<const EdgeView> views, const Dilation& dilation, const EdgeNoise& noise,
                          double slack);

}  // namespace ca2
