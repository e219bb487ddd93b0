#include "core/export/rpy.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace ca2 {

Eigen::Vector3d rpy_from_rotation(const Eigen::Matrix3d& R) {
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  // The roll is what remains once this very yaw is undone, so that its error near the pole is made good.
  const double s = std::sin(yaw), c = std::cos(yaw);
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, pitch, yaw};
}

Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(rpy.z(), Vector3d::UnitZ()) * AngleAxisd(rpy.y(), Vector3d::UnitY()) *
          AngleAxisd(rpy.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

bool near_gimbal_lock(const Eigen::Vector3d& rpy) {
  return std::abs(std::abs(rpy.y()) - std::numbers::pi / 2) < std::numbers::pi / 180;
}

}  // namespace ca2
