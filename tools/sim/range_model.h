/// @file What a LiDAR makes of a true range and of a surface: noise, biases, quantisation.
#pragma once

#include <random>

#include "tools/sim/scenario.h"

namespace ca2 {

/// Diffuse reflectivity in the near infrared of the sheet and of its print: toner absorbs there as it does
/// in visible light.
inline constexpr double paper_reflectivity = 0.8;
inline constexpr double ink_reflectivity = 0.08;

double print_reflectivity(const Board& board, const Eigen::Vector2d& p_board);

/// The range the LiDAR reports [m] for a surface at `range` [m]: biases, noise, quantised to the wire
/// format's step.
double measured_range(const SimulatedLidar& lidar, double range, double reflectivity, std::mt19937_64& rng);

}  // namespace ca2
