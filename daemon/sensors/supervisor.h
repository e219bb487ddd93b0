/// @file A sensor's thread: opens, reads, notices when it is gone, and opens again.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "daemon/sensors/sensor_device.h"
#include "daemon/work/heartbeat.h"
#include "drivers/net/stop_event.h"

namespace ca2 {

using SensorHealths = std::map<std::string, SensorHealth>;  ///< by the rig's name

class Supervisor {
 public:
  /// `report` is called by the sensor's thread, at every change and twice a second.
  Supervisor(std::unique_ptr<SensorDevice> device, std::function<void(SensorHealths)> report,
             Heartbeats& heartbeats);
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;
  ~Supervisor();

  /// Does not wait: the destructor does.
  void stop() noexcept;

 private:
  void run();
  void read();
  void report(const char* supervision, const std::string& problem);

  std::unique_ptr<SensorDevice> device_;
  std::function<void(SensorHealths)> report_;
  std::shared_ptr<Heartbeat> heartbeat_;
  std::string name_;  ///< of its sensors, for the log
  StopEvent stop_;
  std::uint64_t reopened_ = 0;
  std::string last_problem_;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace ca2
