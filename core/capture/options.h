/// @file The capture pipeline's thresholds, with defaults for a person who carries an A3 board.
#pragma once

namespace ca2 {

struct CaptureOptions {
  bool automatic = true;
  double dwell = 0.6;                      ///< s the board must be still
  double camera_motion = 1.0;              ///< px: largest corner motion over the dwell that counts as still
  double lidar_motion = 0.015;             ///< m: largest plane and centre motion over the dwell
  double target_sigma_translation = 2e-3;  ///< m: the stop rule
  double target_sigma_rotation = 1e-3;     ///< rad
  int max_views = 1000;
};

}  // namespace ca2
