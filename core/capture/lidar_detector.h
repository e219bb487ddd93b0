/// @file The search for the board in a LiDAR's stream of scans.
#pragma once

#include <cstdint>
#include <memory>

#include "core/capture/background.h"
#include "core/capture/observation.h"
#include "core/lidar/board_candidate.h"

namespace ca2 {

/// Finds what may be the board, and tells what stands where nothing was before from the furniture. One per
/// LiDAR; the same scans give the same sights. Hosts with no time for a scan leave it out
/// (LidarObservation::searched).
class LidarDetector {
 public:
  LidarDetector(Board board, int lidar) : board_(board), lidar_(lidar), finder_(std::move(board)) {}

  LidarObservation detect(std::int64_t time, std::shared_ptr<const Scan> scan);

 private:
  Board board_;
  int lidar_;
  BoardFinder finder_;
  Background background_;
};

}  // namespace ca2
