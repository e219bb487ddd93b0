/// @file Where and when every beam of a LiDAR looks: what turns ranges into points and what a simulator
/// casts.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// The line a beam measures along, in the vendor's sensor frame: point = origin + range * direction.
/// Ouster: x forward (away from the connector), z up, after lidar_to_sensor_transform. Velodyne: the
/// manual's own frame, azimuth 0 along +y, clockwise seen from above: x = R cos w sin a, y = R cos w cos a,
/// z = R sin w (not the ROS frame, which is x = Y, y = -X).
/// The origin is where range 0 would lie; with an Ouster it is not the centre of its beam circle.
struct BeamRay {
  Eigen::Vector3d origin;     ///< m
  Eigen::Vector3d direction;  ///< unit
};

/// One revolution of a spinning LiDAR with its beams at nominal azimuths: ring r, column c.
/// Rings and columns are counted as Scan does (Ouster: row and measurement id; Velodyne: laser by elevation
/// and firing).
struct BeamTable {
  std::string model;  ///< "OS0-128", "VLP-16", ...
  int rings = 0;
  int columns = 0;
  double rate = 10;                     ///< revolutions per second
  std::vector<BeamRay> rays;            ///< [ring * columns + column]
  std::vector<double> time;             ///< s from the start of the revolution, [ring * columns + column]
  double range_quantum = 0;             ///< m: resolution of the wire format
  double min_range = 0, max_range = 0;  ///< m

  const BeamRay& ray(int ring, int column) const {
    return rays[static_cast<std::size_t>(ring) * columns + column];
  }
};

/// Which sensor: what a rig's `lidars:` entry or a command line says about it.
struct LidarModelSpec {
  std::string model;               ///< name in models.def; may be empty with `metadata`
  std::filesystem::path metadata;  ///< Ouster: the sensor's metadata JSON; empty: nominal angles of `model`
  std::filesystem::path calibration;  ///< Velodyne: XML or YAML; empty: the factory's table
  double rate = 0;                    ///< rev/s: Velodyne and nominal Ouster; 0: 10. Metadata says its own
  int columns = 0;                    ///< nominal Ouster: 512, 1024, 2048 or 4096; 0: 1024
};

/// The beams of one revolution. Fails (ErrorCode::config or data) for an unknown model, an unreadable or
/// malformed file, and for a model whose angles are per unit (HDL-64E) without its calibration.
Result<BeamTable> make_beam_table(const LidarModelSpec& spec);

}  // namespace ca2
