#include "drivers/lidar/lidar_scan.h"

namespace ca2 {

void reuse(LidarScan& out) {
  out.scan.rings = out.scan.columns = 0;
  out.exact.clear();
  out.clock.clear();
  out.frame_id = 0;
  out.complete = false;
  out.missing_packets = 0;
}

}  // namespace ca2
