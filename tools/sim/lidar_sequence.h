/// @file A LiDAR's revolutions in a room in which people move, as what its packets carry.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <vector>

#include "drivers/lidar/encode.h"
#include "tools/sim/beam_echo.h"

namespace ca2 {

/// Every few columns see the people where they are at that moment: a moving board is sheared as a real
/// scanner shears it. What does not move is cast once.
class LidarSequence {
 public:
  /// `room`: the solids that never move. `add_moving` puts the others, as they are at a time (s), behind
  /// them. The LiDAR must outlive the sequence.
  LidarSequence(const SimulatedLidar& lidar, const Scene& room,
                std::function<void(Scene&, double)> add_moving, std::uint64_t seed);

  /// The next revolution. `start`: s, of its first column; `azimuth`: turns, where the head is then (0 for a
  /// LiDAR that fires at encoder positions). EncoderScan::start is left to the caller.
  EncoderScan scan(double start, double azimuth);

 private:
  struct StaticBeam {
    SolidHit hit;
    std::optional<Echo> echo;
  };
  const std::vector<StaticBeam>& static_sweep(int phase);
  std::optional<Echo> measure(const Scene& scene, const std::vector<SolidHit>& hits, std::size_t beam,
                              const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  bool at_edge(const std::vector<SolidHit>& hits, std::size_t beam) const;

  const SimulatedLidar& lidar_;
  Scene room_;
  std::function<void(Scene&, double)> add_moving_;
  std::mt19937_64 rng_;
  std::map<int, std::vector<StaticBeam>> static_;  ///< by azimuth in steps of a quarter column
};

}  // namespace ca2
