#include "core/solve/rim_conflict.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

/// chi-squared with 6 degrees of freedom: a bound one in ten thousand exceeds by chance.
constexpr double chi2_bound_6 = 27.9;
/// What one in two thousand exceeds.
constexpr double most_sigmas = 3.5;

}  // namespace

bool beyond_chance(const Vector6d& change, const Matrix6d& covariance) {
  return !(change.dot(covariance.ldlt().solve(change)) < chi2_bound_6);
}

bool contradicts(const JointAnswer& answer, const JointAnswer& without) {
  if (!answer.covariance.allFinite()) return true;
  if (!without.covariance.allFinite()) return false;
  const std::size_t cameras = answer.state.T_ref_camera.size();
  for (std::size_t l = 0; l < answer.state.T_ref_lidar.size(); ++l) {
    const Vector6d change = without.state.T_ref_lidar[l].difference(answer.state.T_ref_lidar[l]);
    const Eigen::Index i = 6 * static_cast<Eigen::Index>(cameras - 1 + l);
    if (beyond_chance(change, without.covariance.block<6, 6>(i, i))) return true;
  }
  return false;
}

std::vector<Problem> unlikely_ranges(const std::vector<std::string>& lidars, const JointAnswer& answer,
                                     double prior_bias) {
  std::vector<Problem> problems;
  for (std::size_t l = 0; l < lidars.size() && answer.by_rims && prior_bias > 0; ++l) {
    const double bias = answer.state.range_bias[l];
    if (!(std::abs(bias) > most_sigmas * prior_bias)) continue;
    problems.push_back(
        {lidars[l],
         formatted("the plate's rim and the ranges contradict each other: they would agree with "
                   "ranges off by %.0f mm",
                   1e3 * bias),
         "check the outline in the rig; hold the plate by its rim at one place only, free of what "
         "is behind it; show more views"});
  }
  return problems;
}

}  // namespace ca2
