/// @file The search for the board in everything that comes in, by two threads, shedding what there is no time
/// for.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/capture/observation.h"
#include "core/session/rig.h"
#include "daemon/work/heartbeat.h"

namespace ca2 {

/// Where observations go; called by the pool's threads.
struct ObservationSink {
  std::function<void(CameraObservation)> camera;
  std::function<void(LidarObservation)> lidar;
};

/// Per sensor: one search at a time, one frame waiting, the newest; older ones are shed. Observations of a
/// sensor come out in the order of its frames, shed ones (without their picture or scan) among them.
class DetectorPool {
 public:
  DetectorPool(const Rig& rig, ObservationSink sink, Heartbeats& heartbeats);
  DetectorPool(const DetectorPool&) = delete;
  DetectorPool& operator=(const DetectorPool&) = delete;
  /// Waits for the searches under way.
  ~DetectorPool();

  /// Never wait; from any thread. Sensors are indices in the rig's order; times ns UTC.
  void add(int camera, std::int64_t time, std::shared_ptr<const Image> image);
  void add(int lidar, std::int64_t time, std::shared_ptr<const Scan> scan);

 private:
  struct Frame {
    std::int64_t time = 0;
    std::shared_ptr<const Image> image;
    std::shared_ptr<const Scan> scan;
  };
  struct Lane {  ///< a sensor's
    std::function<void(Frame)> search;
    std::function<void(std::int64_t time)> report_shed;
    std::optional<Frame> waiting;
    std::vector<std::int64_t> shed;  ///< times of those older than `waiting` that are not reported yet
    bool busy = false;
  };

  void add(Lane& lane, Frame frame);
  void run(Heartbeat& heartbeat);
  Lane* next();

  std::vector<Lane> cameras_, lidars_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace ca2
