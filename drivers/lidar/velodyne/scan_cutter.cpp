#include "drivers/lidar/velodyne/scan_cutter.h"

namespace ca2 {
namespace {

constexpr int turn = 36000;
constexpr int jitter = 1000;

}  // namespace

int VelodyneScanCutter::past_cut(int azimuth) const {
  return azimuth < cut_ ? azimuth - cut_ + turn : azimuth - cut_;
}

bool VelodyneScanCutter::begins(int azimuth, double advance) {
  const int now = past_cut(azimuth);
  if (!started_) {
    started_ = true;
    last_ = now;
    return false;
  }
  if (advance >= turn) {
    last_ = now;
    return true;
  }
  const int forward = now < last_ ? now - last_ + turn : now - last_;
  if (forward > turn - jitter) return false;  // and the furthest azimuth stays the mark
  const bool wrapped = now < last_;
  last_ = now;
  return wrapped;
}

}  // namespace ca2
