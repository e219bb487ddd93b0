#include "daemon/sensors/lidar_spec.h"

#include "daemon/config/check_sources.h"

namespace ca2 {

Result<LidarDriver> open_lidar_driver(const RigLidar& lidar, const std::filesystem::path& file,
                                      const std::string& host) {
  LidarModelSpec spec;
  spec.model = lidar.model;
  spec.metadata = resolve(lidar.metadata, file);
  spec.calibration = resolve(lidar.calibration, file);
  LidarDriverOptions options;
  options.source_address = host;
  options.streamed_calibration = true;
  return LidarDriver::open(spec, options);
}

}  // namespace ca2
