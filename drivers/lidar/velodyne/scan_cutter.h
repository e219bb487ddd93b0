/// @file Where one revolution of a Velodyne ends and the next begins.
#pragma once

namespace ca2 {

/// Azimuths in 0.01 degree, of firings in order of time.
class VelodyneScanCutter {
 public:
  explicit VelodyneScanCutter(int cut_azimuth) : cut_(cut_azimuth) {}

  /// True when a new scan begins with this firing. `advance`: how far the head must have turned since the
  /// last one, where packets are missing; 0: nothing is missing.
  /// A step back of a few degrees is jitter of a slow head, or an edge of a limited field of view, and no
  /// revolution; anything further back is one of which the rest was lost.
  bool begins(int azimuth, double advance = 0);

  /// The next firing begins the first scan.
  void reset() { started_ = false; }

  /// Of a firing past the cut.
  int past_cut(int azimuth) const;

 private:
  int cut_;
  bool started_ = false;
  int last_ = 0;
};

}  // namespace ca2
