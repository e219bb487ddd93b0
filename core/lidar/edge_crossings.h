/// @file Where the rings of a scan enter and leave the board.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geometry/plane.h"
#include "core/geometry/pose.h"
#include "core/types/scan.h"

namespace ca2 {

struct Projection;

/// The rim of the board lies between two neighbouring rays, of which one ended
/// on the board. That is all a scan says about it, and it does not depend on
/// the noise of the ranges.
struct EdgeCrossing {
  Eigen::Vector3f inside;   ///< unit direction of the ray that ended on the board, sensor frame
  Eigen::Vector3f outside;  ///< of its neighbour past the rim
  /// m: how far behind the board the neighbour ended; infinite: nothing came back. Negative: before it, where
  /// something covers the rim and tells nothing about it.
  float jump = 0;
  std::uint16_t ring = 0;     ///< of `inside`
  bool across_rings = false;  ///< the neighbour is of the next ring, where the board ends between two of them
  float inside_height = 0;    ///< m: where on the z axis the rays begin, see Projection::height
  float outside_height = 0;
};

/// A board found in a scan, roughly: what its rim is looked for around.
struct RimSearch {
  Plane plane;
  Pose T_lidar_board;                       ///< of the plate's centre
  double width, height;                     ///< m, of the plate
  double noise;                             ///< m, of one range
  std::vector<std::uint32_t> covered = {};  ///< returns of what lies on it, rising: see find_covered_returns
};

/// The crossings of the plate's rim, ring by ring. None where the rings are not
/// known. Deterministic.
std::vector<EdgeCrossing> find_edge_crossings(const Scan& scan, const Projection& projection,
                                              const RimSearch& board);

}  // namespace ca2
