#include "core/solve/range_noise.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ca2 {

std::vector<double> range_noise(const JointInput& input, const JointState& state) {
  std::vector<double> sigma = input.range_sigma;
  for (std::size_t l = 0; l < sigma.size(); ++l) {
    double squares = 0;
    double freedom = 0;
    for (const JointView& view : input.views) {
      if (!view.ranges[l]) continue;
      squares += view.ranges[l]->about_own_plane(state.range_bias[l], state.range_slope[l]);
      freedom += view.ranges[l]->weight - 3;
    }
    if (freedom > 0) sigma[l] = std::max(1e-5, std::sqrt(squares / freedom));
  }
  return sigma;
}

void marginalize_view_errors(JointInput& input, std::span<const double> view_sigma) {
  for (JointView& view : input.views) {
    for (std::size_t l = 0; l < view_sigma.size(); ++l) {
      std::optional<RangeSums>& sums = view.ranges[l];
      if (sums) sums = sums->with_shared_error(view_sigma[l], input.range_sigma[l]);
    }
  }
}

}  // namespace ca2
