/// @file Pictures on their way from a driver's thread to the one that calls next().
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <string>

#include "drivers/camera/camera_source.h"

namespace ca2 {

/// Bounded: who does not take pictures in time loses the oldest, and they are counted.
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t limit) : limit_(limit) {}

  /// Forgets what was queued and the loss, but not the interruption.
  void restart();
  void push(CameraFrame frame);
  /// What is queued is still delivered; then pop() answers `lost`. The first reason counts.
  void lose(std::string reason);
  /// pop() answers `stopped` from now on.
  void interrupt() noexcept;
  CameraPoll pop(std::chrono::steady_clock::time_point deadline);

  /// Of one imager, by CameraFrame::stream.
  std::uint64_t delivered(int stream) const;
  std::uint64_t overrun(int stream) const;

 private:
  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<CameraFrame> frames_;
  std::string lost_;
  bool interrupted_ = false;
  std::map<int, std::uint64_t> delivered_, overrun_;  ///< by stream
};

}  // namespace ca2
