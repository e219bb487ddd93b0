/// @file Where sensors' threads put what came in.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/types/image.h"
#include "core/types/scan.h"
#include "drivers/net/datagram.h"

namespace ca2 {

/// Called by many threads at once; never waits. Sensors are indices in the rig's order.
class InputSink {
 public:
  virtual ~InputSink() = default;
  virtual void picture(int camera, const std::string& name, std::int64_t time,
                       std::shared_ptr<const Image> image) = 0;
  virtual void scan(int lidar, std::int64_t time, std::shared_ptr<const Scan> scan) = 0;
  /// Raw, before decoding.
  virtual void datagram(const std::string& lidar, const Datagram& datagram) = 0;
};

}  // namespace ca2
