#include "core/solve/edge_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ca2 {
namespace {

/// Enough views to tell; more only cost time.
constexpr std::size_t most_views = 12;

}  // namespace

std::vector<EdgeSums> edge_sums(const EdgeView& view, const Dilation& dilation, const EdgeNoise& noise,
                                double slack) {
  RimMemo none;
  RimMemo& memo = view.memo ? *view.memo : none;
  return memo.sums(view.crossings, view.outline, view.T_lidar_board, dilation, noise, slack);
}

double estimate_edge_blur(std::span<const EdgeView> views, const Dilation& dilation, double slack) {
  const std::size_t step = 1 + (views.size() - 1) / most_views;
  std::vector<double> needed;
  for (std::size_t i = 0; i < views.size(); i += step) {
    for (const EdgeSums& edge : edge_sums(views[i], dilation, {}, slack)) {
      if (edge.count >= 4) needed.push_back(edge.blur);
    }
  }
  if (needed.empty()) return 0;
  // Single sides with a stray crossing are left to themselves; what is just possible is much too sure.
  std::sort(needed.begin(), needed.end());
  return 2 * needed[needed.size() * 85 / 100];
}

double edge_misfit(const EdgeView& view, const Dilation& dilation, const EdgeNoise& noise, double slack) {
  double misfit = 0;
  for (const EdgeSums& edge : edge_sums(view, dilation, noise, slack)) {
    const Eigen::Vector4d z = edge.at(view.T_lidar_board, dilation);
    misfit += z.dot(edge.H * z);
  }
  return misfit;
}

double mean_center_offset(std::span<const EdgeView> views, const Dilation& dilation, const EdgeNoise& noise,
                          double slack) {
  double squares = 0;
  double count = 0;
  for (const EdgeView& view : views) {
    const auto offset = center_offset(edge_sums(view, dilation, noise, slack), view.T_lidar_board, dilation);
    if (!offset) continue;
    squares += *offset * *offset;
    count += 1;
  }
  return count > 0 ? std::sqrt(squares / count) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace ca2
