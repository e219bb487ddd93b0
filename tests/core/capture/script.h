/// @file A board that moves as told before a camera and a LiDAR, as their detectors would report it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "core/capture/pipeline.h"

namespace ca2::test {

constexpr std::int64_t second = 1'000'000'000;

/// T_camera_board in front of the camera: `x`, `y` m aside, `z` m away, turned by `tilt` rad about the axis
/// at `turn` rad in the board's plane.
Pose board_at(double x, double y, double z, double tilt = 0, double turn = 0);

class Script {
 public:
  Script();

  Rig rig;
  Pose T_camera_lidar;
  double lidar_offset = 0;  ///< s: by how much the LiDAR's clock is ahead
  double camera_rate = 15, lidar_rate = 10;
  double corner_sigma = 0.05;  ///< px
  double range_sigma = 0.01;   ///< m

  /// Where the board is; nothing: out of sight.
  std::function<std::optional<Pose>(double)> T_camera_board = [](double) { return std::nullopt; };
  /// What else the LiDAR holds for a board, LiDAR frame.
  std::function<std::vector<Pose>(double)> others = [](double) { return std::vector<Pose>(); };
  std::function<bool(double)> camera_lost = [](double) { return false; };
  std::function<bool(double)> lidar_lost = [](double) { return false; };

  struct Stored {
    double time = 0;  ///< s
    StoreView view;
  };
  std::vector<Stored> stored;
  std::vector<int> dropped;  ///< ids
  std::vector<CaptureEvent> events;
  std::vector<SolveViews> solves;
  std::function<Result<ViewSights>(const StoreView&)> store;  ///< what the host answers

  /// Runs the pipeline over [from, to] s, observations in the order of their times, answers at once.
  void run(CapturePipeline& pipeline, double from, double to);
  void handle(CapturePipeline& pipeline, double time, CaptureActions actions);

  CameraObservation see(double time);
  LidarObservation scan(double time);

 private:
  LidarSight sight_of(const Pose& T_lidar_board);
  std::mt19937_64 rng_{1};
  std::shared_ptr<const Image> picture_;
  int next_picture_ = 0, next_scan_ = 0;
};

/// A still pose for `duration` s, then the next, half a second of motion between.
class Poses {
 public:
  Poses& hold(const Pose& pose, double duration);
  std::optional<Pose> at(double time) const;
  double end() const { return end_; }

 private:
  struct Hold {
    double from, to;
    Pose pose;
  };
  std::vector<Hold> holds_;
  double end_ = 0;
};

}  // namespace ca2::test
