/// @file Previews of what came in last, made by a thread of their own.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "core/session/rig.h"
#include "daemon/loop/event_loop.h"
#include "daemon/publish/preview.h"
#include "daemon/work/job_thread.h"

namespace ca2 {

/// Lives in the loop's thread.
class PreviewMaker {
 public:
  using Answer = std::function<void(Result<Preview>)>;

  PreviewMaker(EventLoop& loop, Heartbeats& heartbeats);

  void set_rig(const Rig& rig);
  void add(const CameraObservation& observation);
  void add(const LidarObservation& observation);
  /// ErrorCode::usage for a sensor that there is not, `unavailable` while it has given nothing or too many
  /// are asked for.
  void make(const std::string& sensor, int width, Answer answer);
  const std::vector<std::string>& sensors() const { return names_; }  ///< cameras, then LiDARs

 private:
  EventLoop& loop_;
  std::vector<std::string> names_;
  std::vector<CameraObservation> cameras_;  ///< newest searched ones
  std::vector<LidarObservation> lidars_;
  JobThread thread_;
};

}  // namespace ca2
