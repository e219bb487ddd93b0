/// @file The capture pipeline's thresholds, with defaults for a person who carries an A3 board.
#pragma once

namespace ca2 {

struct CaptureOptions {
  bool automatic = true;
  double dwell = 0.6;           ///< s the board must be still
  double patience = 2.5;        ///< dwells after which a sensor that delivers too little holds nobody up
  double board_motion = 0.004;  ///< m: largest motion of the corners over the dwell, as a camera sees it;
                                ///< never less than half a pixel. Hands tremble by a millimetre or two
  double lidar_motion = 0.015;  ///< m: largest motion of the plane over the dwell, as a LiDAR sees it
  double target_sigma_translation = 2e-3;  ///< m: the stop rule
  double target_sigma_rotation = 1e-3;     ///< rad
  int max_views = 1000;
};

}  // namespace ca2
