/// @file Fixed-axis roll, pitch, yaw, as URDF and ROS define them: R = Rz(yaw) Ry(pitch) Rx(roll), rad.
#pragma once

#include <Eigen/Core>

namespace ca2 {

/// (roll, pitch, yaw). Exact to rounding for every rotation, also where the pitch is +-90 degrees and only
/// the sum or the difference of roll and yaw is determined.
Eigen::Vector3d rpy_from_rotation(const Eigen::Matrix3d& R);
Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy);

/// Is the pitch so near +-90 degrees (a degree) that roll and yaw are no numbers to interpret?
bool near_gimbal_lock(const Eigen::Vector3d& rpy);

}  // namespace ca2
