/// @file Signs of life of every thread, for the watchdog.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ca2 {

/// A thread's promise: the next sign comes within the time it gave.
class Heartbeat {
 public:
  using Clock = std::chrono::steady_clock;

  void beat(std::chrono::milliseconds next_within) {
    deadline_.store((Clock::now() + next_within).time_since_epoch().count(), std::memory_order_relaxed);
  }
  bool late(Clock::time_point now) const {
    return now.time_since_epoch().count() > deadline_.load(std::memory_order_relaxed);
  }

 private:
  std::atomic<Clock::rep> deadline_{Clock::time_point::max().time_since_epoch().count()};
};

class Heartbeats {
 public:
  /// A thread's; it counts as long as the thread holds it.
  std::shared_ptr<Heartbeat> add(std::string name) {
    auto beat = std::make_shared<Heartbeat>();
    const std::lock_guard lock(mutex_);
    entries_.emplace_back(std::move(name), beat);
    return beat;
  }

  /// The name of a thread that gave no sign in time; nothing while all live.
  std::optional<std::string> late() {
    const auto now = Heartbeat::Clock::now();
    const std::lock_guard lock(mutex_);
    std::erase_if(entries_, [](const auto& entry) { return entry.second.expired(); });
    for (const auto& [name, weak] : entries_) {
      const auto beat = weak.lock();
      if (beat && beat->late(now)) return name;
    }
    return std::nullopt;
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::weak_ptr<Heartbeat>>> entries_;
};

}  // namespace ca2
