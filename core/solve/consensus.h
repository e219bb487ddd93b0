/// @file Which of a LiDAR's hypotheses is the board in each view, settled by consistency over the views.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/geometry/plane.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// One hypothesis: a patch a LiDAR holds for the board.
struct PatchPlane {
  Plane plane;
  Eigen::Vector3d center;      ///< of the patch, sensor frame, m
  double normal_sigma = 0.02;  ///< rad, about the worse axis
};

/// One view for the consensus: the camera's plane (which is the board for certain) and the LiDAR's
/// hypotheses.
struct ConsensusView {
  Plane camera;
  Eigen::Vector3d center;      ///< of the plate, camera frame, m
  double normal_sigma = 0.01;  ///< rad
  std::vector<PatchPlane> patches;
};

struct ConsensusOptions {
  double board_radius =
      0.25;  ///< m: half of the plate's longer side; how far centres may disagree in the plane
  double distance_sigma = 0.02;  ///< m: how far planes may disagree beside their noise
  double angle_sigma = 0.02;     ///< rad: the same for normals
  std::uint64_t seed = 1;
  int max_hypotheses = 3000;
  std::stop_token stop = {};  ///< no further hypothesis once this is asked for
};

struct Consensus {
  Pose T_camera_lidar;     ///< from the agreeing views' planes and centres
  std::vector<int> patch;  ///< per view: index of the agreeing hypothesis, -1 where none agrees
  int agreeing = 0;
};

/// Searches triples of views (and of their hypotheses) for the relative pose on which most views agree:
/// angles between normals, plane distances, and roughly the boards' centres. Any relative rotation. Nothing
/// when no three views agree. Deterministic for a seed. The cost is bounded: large sets are searched on a
/// sample.
std::optional<Consensus> find_consensus(const std::vector<ConsensusView>& views,
                                        const ConsensusOptions& options);

/// The same question with T_camera_lidar known: which hypothesis of each view agrees with it.
Consensus match_hypotheses(const std::vector<ConsensusView>& views, const Pose& T_camera_lidar,
                           const ConsensusOptions& options);

}  // namespace ca2
