#include "tools/sim/range_model.h"

#include <algorithm>
#include <cmath>

namespace ca2 {

double print_reflectivity(const Board& board, const Eigen::Vector2d& p_board) {
  return board.type->black(board, p_board) ? ink_reflectivity : paper_reflectivity;
}

double measured_range(const SimulatedLidar& lidar, double range, double reflectivity, std::mt19937_64& rng) {
  const LidarNoise& noise = lidar.noise;
  double measured = range + noise.range_bias;
  // A weak echo crosses the detection threshold later: the bias grows linearly from white paper to black.
  measured += noise.reflectivity_bias * (1 - std::min(reflectivity / paper_reflectivity, 1.0));
  measured += noise.range_sigma * std::normal_distribution<double>()(rng);
  const double quantum = lidar.beams.range_quantum;
  return quantum > 0 ? std::round(measured / quantum) * quantum : measured;
}

}  // namespace ca2
