#include "core/solve/rim_conflict.h"

#include <Eigen/Cholesky>

namespace ca2 {
namespace {

/// chi-squared with 6 degrees of freedom: a bound one in ten thousand exceeds by chance.
constexpr double chi2_bound_6 = 27.9;

}  // namespace

bool contradicts(const JointAnswer& answer, const JointAnswer& without) {
  if (!answer.covariance.allFinite()) return true;
  if (!without.covariance.allFinite()) return false;
  const std::size_t cameras = answer.state.T_ref_camera.size();
  for (std::size_t l = 0; l < answer.state.T_ref_lidar.size(); ++l) {
    const Vector6d change = without.state.T_ref_lidar[l].difference(answer.state.T_ref_lidar[l]);
    const Eigen::Index i = 6 * static_cast<Eigen::Index>(cameras - 1 + l);
    if (!(change.dot(without.covariance.block<6, 6>(i, i).ldlt().solve(change)) < chi2_bound_6)) return true;
  }
  return false;
}

}  // namespace ca2
