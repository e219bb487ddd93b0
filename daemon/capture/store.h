/// @file Everything the daemon writes, by one thread, so that the loop never waits for a disk.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/capture/pipeline.h"
#include "core/session/session.h"
#include "daemon/loop/event_loop.h"
#include "daemon/work/job_thread.h"
#include "messages/status.h"

namespace ca2 {

/// A session with what is in it, as the pipeline needs it.
struct OpenSession {
  std::filesystem::path directory;
  Rig rig;
  std::vector<ViewSights> views;
};

struct SessionSummary {
  std::string name;
  int views = 0;
  bool solved = false;
  bool fits = false;         ///< its rig is the one in use
  std::int64_t changed = 0;  ///< ns UTC: its newest view, or its beginning
  std::string problem;       ///< why it cannot be read
};

/// Sessions are STATE/sessions/NAME; STATE/current names the one in use. Answers come back in the loop's
/// thread, after all that was asked for before.
class Store {
 public:
  template <class Value>
  using Answer = std::function<void(Result<Value>)>;

  Store(EventLoop& loop, Heartbeats& heartbeats, std::filesystem::path state);

  /// The session in use when its rig is this one, else a new one.
  void resume(const Rig& rig, Answer<OpenSession> answer);
  /// An empty name: one made of the time.
  void create(const Rig& rig, const std::string& name, Answer<OpenSession> answer);
  /// ErrorCode::config where its rig is another.
  void use(const Rig& rig, const std::string& name, Answer<OpenSession> answer);
  void list(const Rig& rig, Answer<std::vector<SessionSummary>> answer);

  /// Of the session opened last. The answer is what was found in the view, which is the writer's until then.
  void write(std::shared_ptr<StoreView> view, Answer<ViewSights> answer);
  void remove(int view, Answer<bool> answer);
  /// Nothing: the answer that there may be from before is set aside, it is not that of these views.
  void write_result(const Calibration* calibration, Answer<bool> answer);

  /// Of the views written so far. In any thread.
  StoreCost cost() const;

  /// Nothing waits to be written.
  bool idle() const { return thread_.idle(); }

 private:
  template <class Value>
  void run(std::function<Result<Value>()> job, Answer<Value> answer);
  Result<OpenSession> open(const std::string& name, const Rig& rig);
  Result<ViewSights> store(StoreView& view);
  Result<OpenSession> make(const Rig& rig, std::string name);

  EventLoop& loop_;
  const std::filesystem::path state_;
  Session session_;  ///< only the thread's
  mutable std::mutex cost_mutex_;
  StoreCost cost_;
  JobThread thread_;
};

/// The rig as a session keeps it: with absolute paths, so that the session may be moved; `file` is where the
/// rig was read.
Rig session_rig(const Rig& rig, const std::filesystem::path& file);

}  // namespace ca2
