#include "daemon/sensors/lidar_stream.h"

#include "daemon/sensors/lidar_spec.h"

namespace ca2 {

Result<LidarStream> LidarStream::open(const RigLidar& lidar, const std::filesystem::path& file,
                                      const std::string& host) {
  Result<LidarDriver> driver = open_lidar_driver(lidar, file, host);
  if (!driver) return fail(driver.error());
  return LidarStream(std::move(*driver));
}

void LidarStream::push(const Datagram& datagram, const std::function<void(const TimedScan&)>& sink) {
  driver_.push(datagram, [&](LidarScan&& scan) {
    if (const auto timed = clock_.map(std::move(scan))) {
      clock_sigma_ = 1e-9 * timed->time_sigma;
      sink(*timed);
    }
  });
}

std::uint64_t LidarStream::lost() const {
  const LidarCounters& counters = driver_.counters();
  return counters.missing_packets + counters.truncated + counters.wrong_size + counters.wrong_type +
         counters.checksum_errors + counters.late;
}

}  // namespace ca2
