/// @file The one thread that owns all mutable state: descriptors, timers, and what other threads hand in.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "drivers/net/unique_fd.h"

namespace ca2 {

class EventLoop {
 public:
  using Task = std::function<void()>;
  using Handler = std::function<void(std::uint32_t events)>;  ///< EPOLLIN, ...

  EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Only from the loop's thread, or before run().
  void watch(int fd, std::uint32_t events, Handler handler);
  void change(int fd, std::uint32_t events);
  void forget(int fd);
  void every(std::chrono::milliseconds period, Task task);
  void run();
  void stop() { running_ = false; }

  /// Runs the task in the loop's thread; from any other thread. Waits while too many are queued, so that who
  /// is faster than the loop is held back. False (and not run) once the loop has ended.
  bool post(Task task);
  /// As post, but never waits: false also when too many are queued.
  bool try_post(Task task);

 private:
  struct Timer {
    std::chrono::steady_clock::time_point next;
    std::chrono::milliseconds period;
    Task task;
  };

  bool add(Task& task, std::unique_lock<std::mutex>& lock);
  void run_posted();
  int until_next_timer() const;  ///< ms
  void run_timers();

  static constexpr std::size_t max_posted = 256;

  UniqueFd epoll_, wake_;
  bool running_ = true;
  std::map<int, std::shared_ptr<Handler>> handlers_;
  std::vector<std::unique_ptr<Timer>> timers_;

  std::mutex mutex_;  ///< for what follows
  std::condition_variable room_;
  std::deque<Task> posted_;
  bool closed_ = false;
};

}  // namespace ca2
