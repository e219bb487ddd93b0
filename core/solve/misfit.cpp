#include "core/solve/misfit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ca2 {
namespace {

/// Normal deviate that one in ten thousand exceeds.
constexpr double rare = 3.719;

/// By which chi-squared must fall, in units of what is left of it for each degree of freedom: two more
/// unknowns lower it by as much once in 250 000 times.
constexpr double convincing_gain = 25;

/// Quantile of chi-squared, from that of a normal deviate (Wilson and Hilferty 1931).
double chi2_quantile(int freedom, double deviate) {
  const double spread = 2.0 / (9 * freedom);
  return freedom * std::pow(1 - spread + deviate * std::sqrt(spread), 3);
}

/// The largest misfit of one kind over its bound, and whose it is.
std::pair<double, std::size_t> worst(std::span<const Misfit> views, double Misfit::*value,
                                     int Misfit::*freedom) {
  std::vector<double> shares;  // of the median of each view's distribution
  for (const Misfit& view : views) {
    if (view.*freedom > 0) shares.push_back(view.*value / chi2_quantile(view.*freedom, 0));
  }
  if (shares.empty()) return {0, 0};
  std::sort(shares.begin(), shares.end());
  const double typical = std::max(1.0, shares[shares.size() / 2]);
  std::pair<double, std::size_t> worst{0, 0};
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].*freedom <= 0) continue;
    const double share = views[i].*value / (typical * chi2_quantile(views[i].*freedom, rare));
    if (share > worst.first) worst = {share, i};
  }
  return worst;
}

}  // namespace

Misfit& Misfit::operator+=(const Misfit& other) {
  lidars += other.lidars;
  cameras += other.cameras;
  lidar_freedom += other.lidar_freedom;
  camera_freedom += other.camera_freedom;
  return *this;
}

double misfit_excess(double misfit, int freedom) {
  const double ratio = freedom > 0 ? misfit / freedom : 0;
  return ratio > 1 + 3 * std::sqrt(2.0 / std::max(1, freedom)) ? ratio : 1;
}

bool lidars_disagree(const Misfit& misfit) {
  return misfit.lidar_freedom >= 3 && misfit_excess(misfit.lidars, misfit.lidar_freedom) > 1;
}

bool explains(const Misfit& before, const Misfit& after) {
  const double left = after.lidars / std::max(1, after.lidar_freedom);
  return before.lidars - after.lidars > convincing_gain * std::max(1.0, left);
}

std::optional<WorstView> find_worst_view(std::span<const Misfit> views) {
  const auto [lidar_share, lidar_view] = worst(views, &Misfit::lidars, &Misfit::lidar_freedom);
  const auto [camera_share, camera_view] = worst(views, &Misfit::cameras, &Misfit::camera_freedom);
  if (!(std::max(lidar_share, camera_share) > 1)) return std::nullopt;
  const bool by_lidar = lidar_share >= camera_share;
  const std::size_t index = by_lidar ? lidar_view : camera_view;
  const Misfit& misfit = views[index];
  const double ratio =
      by_lidar ? misfit.lidars / misfit.lidar_freedom : misfit.cameras / misfit.camera_freedom;
  const auto times = std::lround(std::min(1e6, std::sqrt(ratio)));
  return WorstView{index, (by_lidar ? "camera and LiDAR" : "the cameras") +
                              std::string(" disagree about the board by ") + std::to_string(times) +
                              " times their noise: it moved, is bent, or another object was taken for it"};
}

}  // namespace ca2
