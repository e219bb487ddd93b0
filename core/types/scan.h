/// @file The returns of a LiDAR: one revolution, or what was gathered over a hold.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace ca2 {

/// Returns as parallel arrays, in the sensor's own frame. `points` is always there; every other array is
/// either empty (not known) or as long as `points`. A missing return is left out, or is a NaN point.
struct Scan {
  std::vector<Eigen::Vector3f> points;  ///< m, vendor's sensor frame
  std::vector<float> intensity;         ///< vendor's unit
  std::vector<float> range;             ///< m, as measured along the ray from the beam's origin
  std::vector<std::uint16_t>
      ring;  ///< Ouster: row, 0 at the top; Velodyne: laser by elevation, 0 at the bottom
  std::vector<std::uint32_t> column;  ///< Ouster: measurement id; Velodyne: firing from the scan's start
  std::vector<std::int64_t> time;     ///< ns, UTC on the host's clock where known
  int rings = 0;                      ///< rings of the sensor; 0: not known
  int columns = 0;                    ///< columns of one revolution; 0: not known

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
  /// How many of the points are returns, not NaN.
  std::size_t returns() const {
    std::size_t count = 0;
    for (const Eigen::Vector3f& point : points) count += point.allFinite() ? 1 : 0;
    return count;
  }
};

}  // namespace ca2
