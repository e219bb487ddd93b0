/// @file Raw input to a recording (docs/recording.md) while everything else goes on.
#pragma once

#include <atomic>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/session/rig.h"
#include "core/types/image.h"
#include "daemon/loop/event_loop.h"
#include "daemon/work/job_thread.h"
#include "drivers/net/datagram.h"

namespace ca2 {

struct RecordingSummary {
  std::string directory;
  std::uint64_t dropped = 0;  ///< inputs that are not in it
};

class Recorder {
 public:
  using Answer = std::function<void(Result<RecordingSummary>)>;

  /// Recordings are STATE/recordings/NAME; `now` is ns UTC.
  Recorder(EventLoop& loop, Heartbeats& heartbeats, std::filesystem::path state,
           std::function<std::int64_t()> now);
  ~Recorder();

  /// From the loop's thread. `rig` as sessions keep it, with absolute paths: its files are copied.
  void set_rig(const Rig& rig) { rig_ = rig; }
  /// What recordings will lack, for who starts one; empty: nothing.
  void set_caveat(std::string caveat) { caveat_ = std::move(caveat); }
  const std::string& caveat() const { return caveat_; }
  /// An empty name: one made of the time. The directory is made at once, so that a wrong name or a full disk
  /// is told to who asked.
  Result<std::string> start(const std::string& name);
  /// Answers when everything is on the disk.
  void stop(Answer answer);
  /// Empty: not recording.
  std::string directory() const;
  std::uint64_t dropped() const { return dropped_; }
  /// Nothing waits to be written.
  bool idle() const { return thread_.idle(); }

  /// From any thread; never wait. What the disk cannot keep up with is dropped, and counted.
  void picture(const std::string& camera, std::int64_t time, std::shared_ptr<const Image> image);
  void datagram(const std::string& lidar, const Datagram& datagram);

 private:
  class Files;
  struct Packets;  ///< datagrams that own their bytes

  void submit(std::size_t bytes, std::function<void(Files&)> job);
  void flush(const std::string& lidar, Packets& packets);

  EventLoop& loop_;
  std::filesystem::path state_;
  std::function<std::int64_t()> now_;
  Rig rig_;
  std::string caveat_;
  std::atomic<bool> on_{false};
  std::atomic<std::size_t> waiting_bytes_{0};
  std::atomic<std::uint64_t> dropped_{0};

  std::mutex mutex_;  ///< for files_ and gathered_
  std::shared_ptr<Files> files_;
  std::map<std::string, std::shared_ptr<Packets>> gathered_;  ///< by LiDAR
  JobThread thread_;
};

}  // namespace ca2
