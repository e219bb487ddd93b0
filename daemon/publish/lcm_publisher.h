/// @file What goes out over LCM.
#pragma once

#include <lcm/lcm-cpp.hpp>
#include <string>

#include "core/session/calibration.h"
#include "daemon/publish/preview.h"
#include "messages/status.h"

namespace ca2 {

/// Lives in the loop's thread; publishing is one datagram, or a few, handed to the kernel.
class LcmPublisher {
 public:
  explicit LcmPublisher(lcm::LCM& lcm) : lcm_(lcm) {}

  void status(const DaemonStatus& status);
  void view(const std::string& session, int id, bool stored, int views, std::int64_t time);
  /// `time`: ns UTC, when it was solved.
  void extrinsics(const Calibration& calibration, const std::string& session, std::int64_t time);
  void preview(const std::string& sensor, const Preview& preview);

 private:
  template <class Message>
  void publish(const char* channel, const Message& message);

  lcm::LCM& lcm_;
  bool failed_ = false;  ///< the last one was not sent: told once
};

}  // namespace ca2
