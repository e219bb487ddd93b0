/// @file Where and when every beam of a LiDAR looks: what turns ranges into points and what a simulator
/// casts.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ca2 {

/// The line a beam measures along, in the vendor's sensor frame: point = origin + range * direction.
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

}  // namespace ca2
