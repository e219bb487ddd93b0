/// @file All sensors of a rig at work: their threads, and the search in what they give.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/record/recorder.h"
#include "daemon/sensors/input_sink.h"
#include "daemon/sensors/supervisor.h"
#include "daemon/work/detector_pool.h"
#include "drivers/recording/recording.h"

namespace ca2 {

class SensorSet : public InputSink {
 public:
  /// `observations` and `healths` are called by many threads. `recording`: takes the place of the sensors.
  SensorSet(const Config& config, const std::optional<Recording>& recording, Recorder& recorder,
            ObservationSink observations, std::function<void(SensorHealths)> healths, Heartbeats& heartbeats);
  /// Waits for the threads: a camera that is being opened or closed may take seconds.
  ~SensorSet() override;

  /// Asks all to end; does not wait.
  void stop() noexcept;

  void picture(int camera, const std::string& name, std::int64_t time,
               std::shared_ptr<const Image> image) override;
  void scan(int lidar, std::int64_t time, std::shared_ptr<const Scan> scan) override;
  void datagram(const std::string& lidar, const Datagram& datagram) override;

 private:
  Recorder& recorder_;
  DetectorPool detectors_;
  std::vector<std::unique_ptr<Supervisor>> supervisors_;  ///< last: they use the others
};

}  // namespace ca2
