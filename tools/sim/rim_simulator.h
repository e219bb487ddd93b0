/// @file Where a LiDAR's rings enter and leave the plate, as a perfect extraction would tell.
#pragma once

#include <random>
#include <vector>

#include "core/lidar/edge_crossings.h"
#include "tools/sim/plate.h"
#include "tools/sim/scenario.h"

namespace ca2 {

/// Share of the beam's full width by which a plate looks too large all round: what stands behind a rim is
/// farther away and answers more weakly, so that a beam with less than half of its width on the plate returns
/// the plate.
inline constexpr double dilation_per_width = 0.35;

/// Where on the z axis a ring's beams seem to begin, m: their nearest place to it. A scan shows it as
/// Projection::height.
double beam_height(const BeamTable& beams, int ring);

/// Gathers the looks of one view's revolutions at the plate and beside it.
class RimSimulator {
 public:
  RimSimulator(const SimulatedLidar& lidar, const Pose& T_lidar_board, const Plate& plate);

  /// One revolution, its beams turned by `azimuth` [rad] as in `cast_on_plate`. Lost returns are lost here
  /// too.
  void add_revolution(double azimuth, std::mt19937_64& rng);
  std::vector<EdgeCrossing> crossings() const;

 private:
  struct Look {
    double azimuth = 0;         ///< rad, from the plate's centre
    Eigen::Vector3d direction;  ///< unit, from the ring's place on the z axis
    bool on_plate = false;
  };
  bool answers(const BeamRay& ray) const;
  void add_ends(std::size_t ring, std::vector<EdgeCrossing>& crossings) const;
  void add_between(std::size_t last, std::size_t beyond, std::vector<EdgeCrossing>& crossings) const;

  const SimulatedLidar& lidar_;
  Pose T_lidar_board_;
  Plate plate_;
  Plate around_;  ///< the plate and what is beside it
  double azimuth_ = 0;
  std::vector<double> heights_;  ///< m, by ring
  std::vector<std::vector<Look>> rings_;
};

}  // namespace ca2
