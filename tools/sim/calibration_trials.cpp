#include "tools/sim/calibration_trials.h"

#include <Eigen/Cholesky>

namespace ca2 {

Pose true_transform(const Scenario& scenario, const std::string& parent, const std::string& child) {
  return scenario.T_rig_sensor(parent).inverse() * scenario.T_rig_sensor(child);
}

TransformError error_of(const CalibratedTransform& transform, const Pose& T_parent_child) {
  const Vector6d d = transform.T_parent_child.difference(T_parent_child);
  return {d.tail<3>().norm(), d.head<3>().norm(), d.dot(transform.covariance.ldlt().solve(d))};
}

TransformError worst_error(const Calibration& calibration, const Scenario& scenario) {
  TransformError worst{0, 0, -1};
  for (const CalibratedTransform& transform : calibration.transforms) {
    if (!scenario.lidars.contains(transform.child)) continue;
    const TransformError error =
        error_of(transform, true_transform(scenario, transform.parent, transform.child));
    if (error.nees > worst.nees) worst = error;
  }
  return worst;
}

Rig misstated_rig(Rig rig, const IntrinsicsError& error, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(-1, 1);
  for (auto& [name, camera] : rig.cameras) {
    CameraParameters& parameters = camera.intrinsics->parameters;
    parameters.head<2>() *= 1 + error.focal * unit(rng);
    parameters(2) += error.pixel * unit(rng);
    parameters(3) += error.pixel * unit(rng);
  }
  return rig;
}

Result<std::vector<SimulatedView>> simulate_pool(Scenario scenario, int count) {
  scenario.views = count;
  return simulate_feature_views(scenario);
}

}  // namespace ca2
