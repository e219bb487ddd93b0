/// @file What the estimator is given: where each sensor saw the board in each view.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/geometry/plane.h"
#include "core/geometry/pose.h"
#include "core/lidar/edge_crossings.h"

namespace ca2 {

/// A camera's sight of the board in one view.
struct CameraSight {
  std::vector<Corner> corners;
  BoardPose pose;  ///< from this picture alone, with the intrinsics as given
};

/// A return that lies on the board, or near it.
struct BoardReturn {
  static constexpr std::uint16_t no_ring = 0xffff;
  static constexpr std::uint16_t no_intensity = 0xffff, full_intensity = 0xfffe;
  Eigen::Vector3f point;  ///< sensor frame, m
  std::uint16_t ring = no_ring;
  /// Of the sight's strongest return it is this share, in 1 / full_intensity; no_intensity: not known.
  std::uint16_t intensity = no_intensity;
  float height = 0;  ///< m: where on the z axis its ray begins, see Projection::height
};

/// A LiDAR's possible sight of the board in one view: one hypothesis of several.
struct LidarSight {
  Plane plane;                          ///< sensor frame, as the finder fitted it
  Eigen::Vector3d center;               ///< of the patch, sensor frame, m: rough
  std::vector<EdgeCrossing> crossings;  ///< of the plate's rim; only where the rig gives an outline
  double rms = 0;                       ///< m
  double score = 0;                     ///< the finder's, 0..1
  std::vector<BoardReturn> on_board;    ///< returns the finder holds for the board, sensor frame, m
  std::vector<BoardReturn> around;      ///< the other returns whose rays pass close to the board
};

/// One view: what each camera and each LiDAR of the rig saw, by index.
struct ViewSights {
  int id = 0;
  std::vector<std::optional<CameraSight>> cameras;
  std::vector<std::vector<LidarSight>> lidars;  ///< hypotheses, best first; empty: not seen
  std::string problem;  ///< why a sensor has none, for a person; empty when all is well
};

}  // namespace ca2
