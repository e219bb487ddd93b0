/// @file The place in a LiDAR that its beams really come from.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/features/sights.h"
#include "core/solve/joint_solver.h"

namespace ca2 {

/// Where the beams of LiDAR `lidar` come from, on the z axis of the sensor's frame, m; zero where the rings
/// are not known or do not tell. Vendors put the frame's origin at the base (an OS0: 38 mm below the beams)
/// or elsewhere. A ring's returns lie on a cone whatever their range and its noise: its line in the plane of
/// radius and z, continued to the axis, is where it comes from; the centre is the mean over the rings.
Eigen::Vector3d beam_center(const std::vector<ViewSights>& views, std::size_t lidar);

/// The same sights with the origin of LiDAR `lidar` at `center`: ranges then err along the rays from the
/// origin, and sides of the board are seen as they are from there.
void move_origin(std::vector<ViewSights>& views, std::size_t lidar, const Eigen::Vector3d& center);

/// Takes an answer from such sights back to the sensor's own frame. `first` is the index of the LiDAR's pose
/// among the globals.
void restore_origin(JointAnswer& answer, std::size_t lidar, Eigen::Index first,
                    const Eigen::Vector3d& center);

}  // namespace ca2
