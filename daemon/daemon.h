/// @file The daemon: everything it has, in the order in which it depends on each other.
#pragma once

#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <string>

#include "daemon/capture/capture_host.h"
#include "daemon/clock.h"
#include "daemon/config/config.h"
#include "daemon/dispatch/dispatcher.h"
#include "daemon/doors/lcm_door.h"
#include "daemon/doors/socket_door.h"
#include "daemon/loop/event_loop.h"
#include "daemon/publish/lcm_publisher.h"
#include "daemon/publish/preview_maker.h"
#include "daemon/record/recorder.h"
#include "daemon/sensors/sensor_set.h"

namespace ca2 {

class Daemon {
 public:
  /// The configuration as the command line says, read anew.
  using ReadAgain = std::function<Result<Config>()>;

  /// `recording`: takes the place of the sensors. `read_again`: for a reload.
  Daemon(Config config, std::optional<Recording> recording, ReadAgain read_again);
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  /// Waits for every thread.
  ~Daemon();

  /// Opens the doors. The signals that the daemon hears must be blocked in all threads.
  Result<void> open();
  /// Until a signal says to stop.
  void run();

 private:
  Result<void> open_lcm();
  void start_sensors();
  void retire_sensors();
  void reload();
  void begin_stop();
  void tick();
  void publish_if_due();
  void publish_previews();
  void feed_watchdog();
  void hear_signals();
  void heard(const std::string& kind, const std::string& text);
  DaemonStatus status();

  Config config_;
  std::optional<Recording> recording_;
  ReadAgain read_again_;
  HostClock clock_;
  EventLoop loop_;
  Heartbeats heartbeats_;
  std::shared_ptr<Heartbeat> loop_beat_;
  UniqueFd signals_;
  UniqueFd state_;  ///< held: no other daemon's

  std::unique_ptr<lcm::LCM> lcm_;
  std::unique_ptr<LcmPublisher> publisher_;
  PreviewMaker previews_;
  Recorder recorder_;
  SensorHealths healths_;
  std::unique_ptr<CaptureHost> capture_;
  std::unique_ptr<SocketDoor> socket_door_;
  std::unique_ptr<LcmDoor> lcm_door_;
  JobThread reaper_;  ///< waits for the threads of sensors that are no longer used
  std::shared_ptr<SensorSet> sensors_;
  std::shared_ptr<bool> current_;  ///< false: what these sensors still give is no longer wanted

  std::uint64_t sequence_ = 0;
  std::string published_;  ///< what a change of is published at once
  std::chrono::steady_clock::time_point next_status_, next_extrinsics_, next_preview_;
  std::size_t preview_turn_ = 0;
  std::string late_thread_;  ///< the watchdog is not fed because of it
  std::optional<std::chrono::steady_clock::time_point> stopping_until_;
  bool restart_wanted_ = false;  ///< the clock was set
};

}  // namespace ca2
