/// @file What the capture pipeline is fed: a picture or a scan, and what a detector found in it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/types/image.h"
#include "core/types/scan.h"

namespace ca2 {

/// A camera's picture, searched. `camera` is an index in the rig's order (by name).
struct CameraObservation {
  int camera = 0;
  std::int64_t time = 0;               ///< ns UTC, host clock: the middle of the exposure
  std::shared_ptr<const Image> image;  ///< as the camera gave it
  std::vector<Corner> corners;         ///< empty: the board was not found
  bool searched = true;                ///< false: shed, the detectors had no time for it; or spared
  bool spared = false;                 ///< the board has been away: some pictures a second are enough
};

/// A LiDAR's scan, searched. `lidar` is an index in the rig's order (by name).
struct LidarObservation {
  int lidar = 0;
  std::int64_t time = 0;  ///< ns UTC, host clock: the middle of the revolution
  std::shared_ptr<const Scan> scan;
  std::vector<LidarSight> sights;  ///< hypotheses, best first; empty: no board found
  /// By sight: share of its returns that lie where nothing was before, 0..1; NaN: not known yet. A board that
  /// a person brought is new there; furniture of its size is not.
  std::vector<double> novelty;
  bool searched = true;
};

}  // namespace ca2
