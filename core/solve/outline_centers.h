/// @file The plate's centre as its outline shows it to a LiDAR: what fixes the position inside the planes.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/features/sights.h"
#include "core/geometry/pose.h"
#include "core/solve/joint_problem.h"

namespace ca2 {

/// In-plane vector [m, sensor frame] from where the plate's centre should be, the board being at
/// T_lidar_board, to where the sight's outline has it; nothing without an outline. `plate_center`: board
/// frame, m.
std::optional<Eigen::Vector3d> center_error(const LidarSight& sight, const Pose& T_lidar_board,
                                            const Eigen::Vector2d& plate_center);

/// Standard deviation per coordinate from the lengths of such errors (at least 3), by their median; not under
/// 2 mm.
double center_sigma(std::vector<double> lengths);

/// The centre as an observation for the joint problem; far-off ones weigh less (Huber at two sigma).
CenterSight observe_center(const Eigen::Vector3d& error, const Pose& T_lidar_board,
                           const Eigen::Vector2d& plate_center, double sigma);

}  // namespace ca2
