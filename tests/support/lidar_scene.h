/// @file A room with furniture and a person who holds a board, as a LiDAR sees it: truth for the finder's
/// tests. Everything follows from the seed.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/geometry/plane.h"
#include "core/geometry/pose.h"
#include "core/types/scan.h"

namespace ca2::test {

/// A spinning LiDAR, as far as a finder could notice.
struct SceneSensor {
  std::string name;
  std::vector<double> elevation;  ///< rad, by ring
  std::vector<double> azimuth;    ///< rad, by ring: beside the column's
  std::vector<double> lift;       ///< m, by ring: the beam starts so far above the origin
  double radius = 0;              ///< m, and so far from the axis
  int columns = 0;
  double divergence = 0;       ///< rad, full width of the beam
  double mount_height = 1.0;   ///< m above the floor
  double least_elevation = 0;  ///< rad: where boards are held, to stay in view
  double most_elevation = 0;

  static SceneSensor vlp16();
  static SceneSensor os0_128();
  static SceneSensor hdl64e();
};

/// Solid shapes; local frames are centred.
struct SceneShape {
  enum class Kind { box, room, ellipsoid, capsule };
  Kind kind = Kind::box;
  Pose T_scene_shape;
  Eigen::Vector3d half;  ///< m: half edges; radii; capsule: (radius, half length along z, 0)

  /// Range (m) along the unit direction at which a ray enters (a room: leaves), or infinity.
  double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  double bounding_radius() const;
};

/// What is put in front of the sensor.
struct SceneSetup {
  double width = 0.42, height = 0.297;   ///< m, the plate
  double nearest = 1.0, farthest = 2.5;  ///< m, to the plate
  double tilt = 0.7;                     ///< rad, largest angle between its normal and the line of sight
  bool furniture = true;
};

/// How the scan is handed over.
enum class ScanForm {
  full,      ///< ring and column known, missing returns left out
  nan_grid,  ///< organised by column, missing returns are NaN, ring and column known
  rings,     ///< ring known, no column, in firing order
  bare,      ///< only points; zeros for missing returns
  shuffled,  ///< ring known, in no order
};

struct Scene {
  Scan scan;
  std::vector<std::uint8_t> on_board;  ///< per return of the scan: the pulse hit the board and nothing else
  Pose T_lidar_board;                  ///< truth; z away from the sensor
  Plane plane;                         ///< truth
  std::vector<SceneShape> shapes;  ///< all there is; the plate first, then the room, the person, furniture
  double noise = 0;                ///< m, of ranges
  double hidden = 0;               ///< share of the plate that something stands before
};

/// Throws the dice until the plate is in view (a person waving it would). `form` changes nothing but the
/// arrays.
Scene make_scene(const SceneSensor& sensor, const SceneSetup& setup, ScanForm form, std::uint64_t seed);

}  // namespace ca2::test
