/// @file The capture pipeline before simulated features: a carried board as perfect detectors would report
/// it, with what else a LiDAR takes for a board. Nothing is rendered: hundreds of holds in seconds.
#pragma once

#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/capture/pipeline.h"
#include "tools/sim/person_motion.h"

namespace ca2::test {

/// A view that the pipeline had stored.
struct StoredView {
  double time = 0;                  ///< s, when it was asked for
  double first = 0, last = 0;       ///< s, of its pictures
  std::size_t pictures = 0;         ///< of the first of its cameras
  std::vector<std::string> lidars;  ///< that are in it
};

struct FeatureHostOptions {
  double clock_offset = 0;  ///< s: the cameras' stamps are late by so much
  double lost = 0;          ///< share of pictures and scans that never come
  double detection = 0.08;  ///< s from a picture or scan to its search's end
  int solves = 8;           ///< views after which nothing is solved any more: 200 would take minutes
  /// Is the LiDAR blind to the board in this hold? It still has the furniture, and whoever holds the board.
  std::vector<int> blind_holds;
};

/// Drives the pipeline through the motion and keeps what it stores.
class FeatureHost {
 public:
  FeatureHost(const Scenario& scenario, const PersonMotion& motion, FeatureHostOptions options);
  void run();
  /// s of the motion, of an event's time.
  static double seconds(std::int64_t time);

  std::vector<StoredView> stored;
  std::vector<CaptureEvent> events;

 private:
  struct Due {
    double arrival = 0, time = 0;  ///< s
    bool picture = false;
    int sensor = 0;
  };
  CameraObservation see(int camera, double time);
  LidarObservation scan(int lidar, double time);
  LidarSight plate_sight(const SimulatedLidar& lidar, double time);
  LidarSight patch(const Pose& T_lidar_patch, double width, double height);
  const TrueHold* hold_at(double time) const;
  void handle(double time, const CaptureActions& actions);
  Result<ViewSights> store(double time, const StoreView& view);

  const Scenario& scenario_;
  const PersonMotion& motion_;
  FeatureHostOptions options_;
  std::vector<std::string> cameras_, lidars_;
  CapturePipeline pipeline_;
  std::mt19937_64 rng_{7};
  std::shared_ptr<const Image> picture_;
  std::shared_ptr<const Scan> scan_;
  std::map<int, LidarObservation> newest_scan_;
  std::map<int, CameraObservation> newest_picture_;
};

}  // namespace ca2::test
