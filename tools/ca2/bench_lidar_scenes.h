/// @file The scans that `ca2 bench lidar` and its peers search for the board.
#pragma once

#include <vector>

#include "core/board/board.h"
#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

/// An A3 sheet with its outline.
Board lidar_bench_board();

/// One revolution of an OS0-128 (128 x 1024) in a furnished room of its own.
struct LidarBenchScene {
  Scan present;             ///< a person holds the board, 1 to 2.5 m away
  Scan absent;              ///< the person stands there with empty hands
  Eigen::Vector3d p_board;  ///< m, LiDAR frame, where the board is
};

/// Always the same ones. Errors: the simulator's.
Result<std::vector<LidarBenchScene>> lidar_bench_scenes(int count);

}  // namespace ca2
