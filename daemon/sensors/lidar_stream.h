/// @file A LiDAR's datagrams to scans on the host's clock, with counts.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/session/rig.h"
#include "drivers/lidar/lidar_driver.h"
#include "drivers/lidar/scan_clock.h"

namespace ca2 {

class LidarStream {
 public:
  /// `file` is the rig's; `host`: only datagrams from there, empty: from anyone.
  static Result<LidarStream> open(const RigLidar& lidar, const std::filesystem::path& file,
                                  const std::string& host);

  void push(const Datagram& datagram, const std::function<void(const TimedScan&)>& sink);

  const std::string& model() const { return driver_.model(); }
  double clock_sigma() const { return clock_sigma_; }  ///< s; NaN before the first scan
  std::uint64_t lost() const;                          ///< packets that never came or were no good

 private:
  explicit LidarStream(LidarDriver driver) : driver_(std::move(driver)) {}

  LidarDriver driver_;
  ScanClock clock_;
  double clock_sigma_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace ca2
