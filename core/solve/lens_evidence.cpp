#include "core/solve/lens_evidence.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

/// So many numbers known of rims are needed beyond what is fitted to them.
constexpr int least_freedom = 24;
/// Enough views to tell; more only cost time.
constexpr std::size_t most_views = 24;

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

double lens_gain(std::span<const EdgeView> views, const Dilation& dilation, double blur, double slack,
                 const RimFreedom& free, double radius) {
  const std::vector<EdgeView> some = some_of(views);
  std::vector<std::vector<EdgeCrossing>> crossings;
  std::vector<EdgeView> other = some;
  for (EdgeView& view : other) {
    auto& list = crossings.emplace_back(view.crossings.begin(), view.crossings.end());
    for (EdgeCrossing& crossing : list) move_through_lens(crossing, radius);
    view.crossings = list;
    view.memo = nullptr;
  }
  return gain(fitted_errors(rim_residuals(some, dilation, blur, slack), free),
              fitted_errors(rim_residuals(other, dilation, blur, slack), free));
}

float height_through_lens(const Eigen::Vector3f& way, double radius) {
  return static_cast<float>(-radius * way.z() / way.head<2>().norm());
}

void move_through_lens(EdgeCrossing& crossing, double radius) {
  crossing.inside_height = height_through_lens(crossing.inside, radius);
  crossing.outside_height = height_through_lens(crossing.outside, radius);
}

}  // namespace ca2
