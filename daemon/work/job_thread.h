/// @file A thread that does jobs, one at a time, in order.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "daemon/work/heartbeat.h"
#include "daemon/work/thread_priority.h"

namespace ca2 {

class JobThread {
 public:
  using Job = std::function<void()>;
  /// One that gives up soon once it is asked to.
  using StoppableJob = std::function<void(const std::stop_token&)>;

  /// `longest`: a job that takes more counts as stuck.
  JobThread(const std::string& name, Heartbeats& heartbeats, std::size_t capacity,
            std::chrono::seconds longest, Urgency urgency = Urgency::can_wait);
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;
  /// Asks the job under way to stop and waits for it; what is queued is not done.
  ~JobThread();

  /// False, and not done, when as many as may wait are waiting.
  bool submit(Job job);
  /// In place of all that wait, and of the one under way: it is asked to stop.
  void replace(StoppableJob job);
  /// Nothing waits and nothing is under way.
  bool idle() const;

 private:
  void run();

  const std::size_t capacity_;
  const std::chrono::seconds longest_;
  std::shared_ptr<Heartbeat> heartbeat_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<StoppableJob> jobs_;
  std::stop_source current_;  ///< of the job under way
  bool busy_ = false, stop_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace ca2
