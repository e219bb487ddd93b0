#include "core/solve/edge_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/solve/misfit.h"

namespace ca2 {
namespace {

/// Enough views to tell; more only cost time.
constexpr std::size_t most_views = 12;

}  // namespace

double estimate_edge_blur(std::span<const EdgeView> views, double dilation, double slack) {
  const std::size_t step = 1 + (views.size() - 1) / most_views;
  std::vector<double> needed;
  for (std::size_t i = 0; i < views.size(); i += step) {
    const EdgeView& view = views[i];
    for (const EdgeSums& edge :
         edge_sums(view.crossings, view.outline, view.T_lidar_board, dilation, {}, slack)) {
      if (edge.count >= 4) needed.push_back(edge.blur);
    }
  }
  if (needed.empty()) return 0;
  // Single sides with a stray crossing are left to themselves; what is just possible is much too sure.
  std::sort(needed.begin(), needed.end());
  return 2 * needed[needed.size() * 85 / 100];
}

double edge_misfit(const EdgeView& view, double dilation, const EdgeNoise& noise, double slack) {
  double misfit = 0;
  for (const EdgeSums& edge :
       edge_sums(view.crossings, view.outline, view.T_lidar_board, dilation, noise, slack)) {
    const Eigen::Vector4d z = edge.at(view.T_lidar_board, dilation);
    misfit += z.dot(edge.H * z);
  }
  return misfit;
}

double mean_center_offset(std::span<const EdgeView> views, double dilation, const EdgeNoise& noise,
                          double slack) {
  double squares = 0;
  double count = 0;
  for (const EdgeView& view : views) {
    const auto offset =
        center_offset(edge_sums(view.crossings, view.outline, view.T_lidar_board, dilation, noise, slack),
                      view.T_lidar_board, dilation);
    if (!offset) continue;
    squares += *offset * *offset;
    count += 1;
  }
  return count > 0 ? std::sqrt(squares / count) : std::numeric_limits<double>::quiet_NaN();
}

double estimate_shared_edge_error(std::span<const EdgeView> views, double dilation, double blur,
                                  double slack) {
  static constexpr std::array sizes{0.0001, 0.0002, 0.0004, 0.0006, 0.0012,
                                    0.0024, 0.0048, 0.0096, 0.02};  // m
  struct Seen {
    EdgeSums edge;
    Eigen::Vector4d z;
  };
  std::vector<Seen> all;
  int freedom = -7;  // the LiDAR's pose and the dilation follow the sides
  for (const EdgeView& view : views) {
    for (const EdgeSums& edge :
         edge_sums(view.crossings, view.outline, view.T_lidar_board, dilation, {blur, 0}, slack)) {
      all.push_back({edge, edge.at(view.T_lidar_board, dilation)});
      freedom += edge.freedom;
    }
  }
  const auto explained = [&](double shared) {
    double misfit = 0;
    for (Seen& one : all) {
      one.edge.share(shared);
      misfit += one.z.dot(one.edge.H * one.z);
    }
    return freedom <= 0 || misfit_excess(misfit, freedom) == 1;
  };
  // No plate is cut, and no print placed on it, to less than the first of them.
  for (const double shared : sizes) {
    if (explained(shared)) return shared;
  }
  return sizes.back();
}

}  // namespace ca2
