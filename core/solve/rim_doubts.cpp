#include "core/solve/rim_doubts.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

/// So many numbers known of rims are needed beyond what is fitted to them.
constexpr int least_freedom = 24;
/// Enough views to tell; more only cost time.
constexpr std::size_t most_views = 24;

/// How far up the axis a beam in this direction meets it, m.
float height_on_axis(const Eigen::Vector3f& way, double radius) {
  return static_cast<float>(-radius * way.z() / way.head<2>().norm());
}

void move_crossing(EdgeCrossing& crossing, double radius) {
  crossing.inside_height = height_on_axis(crossing.inside, radius);
  crossing.outside_height = height_on_axis(crossing.outside, radius);
}

/// Are the rays closer to beginning at the frame's origin than in the lens? What a scan shows of it is only
/// known to a millimetre.
bool begin_at_origin(std::span<const EdgeCrossing> crossings, double radius) {
  double as_stated = 0, by_lens = 0;  // m
  for (const EdgeCrossing& crossing : crossings) {
    as_stated += std::abs(crossing.inside_height);
    by_lens += std::abs(height_on_axis(crossing.inside, radius));
  }
  return as_stated < 0.5 * by_lens;
}

std::vector<EdgeView> some_of(std::span<const EdgeView> views) {
  std::vector<EdgeView> some;
  const std::size_t step = 1 + views.size() / most_views;
  for (std::size_t i = 0; i < views.size(); i += step) some.push_back(views[i]);
  return some;
}

/// Logarithm of how much more probable the second is. The sides they are from need not be the same.
double gain(const RimErrors& first, const RimErrors& second) {
  const int freedom = std::min(first.freedom, second.freedom);
  if (freedom < least_freedom) return 0;
  return 0.5 * freedom * (first.deviance / first.freedom - second.deviance / second.freedom);
}

}  // namespace

double freedom_gain(std::span<const EdgeView> views, const Dilation& dilation, double blur, double slack) {
  const RimResiduals residuals = rim_residuals(some_of(views), dilation, blur, slack);
  return gain(fitted_errors(residuals, {}), fitted_errors(residuals, rim_freedom));
}

double lens_gain(std::span<const EdgeView> views, const Dilation& dilation, double blur, double slack,
                 const RimFreedom& free, double radius) {
  const std::vector<EdgeView> some = some_of(views);
  std::vector<std::vector<EdgeCrossing>> crossings;
  std::vector<EdgeView> other = some;
  for (EdgeView& view : other) {
    auto& list = crossings.emplace_back(view.crossings.begin(), view.crossings.end());
    if (!begin_at_origin(list, radius)) return 0;
    for (EdgeCrossing& crossing : list) move_crossing(crossing, radius);
    view.crossings = list;
    view.memo = nullptr;
  }
  return gain(fitted_errors(rim_residuals(some, dilation, blur, slack), free),
              fitted_errors(rim_residuals(other, dilation, blur, slack), free));
}

std::vector<ViewSights> through_lens(std::vector<ViewSights> views, std::size_t lidar, double radius) {
  for (ViewSights& view : views) {
    for (LidarSight& sight : view.lidars[lidar]) {
      for (auto* returns : {&sight.on_board, &sight.around}) {
        for (BoardReturn& one : *returns) {
          const float height = height_on_axis(one.point, radius);
          one.point.z() += height - one.height;
          one.height = height;
        }
      }
      for (EdgeCrossing& crossing : sight.crossings) move_crossing(crossing, radius);
    }
  }
  return views;
}

}  // namespace ca2
