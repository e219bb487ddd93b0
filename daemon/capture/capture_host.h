/// @file The capture pipeline in its daemon: does what the pipeline asks for, and keeps trying where the disk
/// says no.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/capture/pipeline.h"
#include "daemon/capture/store.h"
#include "daemon/config/config.h"
#include "daemon/work/job_thread.h"

namespace ca2 {

/// Lives in the loop's thread.
class CaptureHost {
 public:
  /// What others are told; all are called in the loop's thread.
  struct Listener {
    std::function<void(const CaptureEvent&)> event;
    std::function<void(int view, bool stored)> view;  ///< stored, or dropped
    std::function<void()> changed;                    ///< the status may have changed
  };
  template <class Value>
  using Answer = std::function<void(Result<Value>)>;

  CaptureHost(EventLoop& loop, Heartbeats& heartbeats, const Config& config,
              std::function<std::int64_t()> now, Listener listener);

  /// Takes another configuration over, or begins anew after a jump of the clock: the session is opened again.
  void restart(const Config& config);
  void new_session(const std::string& name, Answer<std::string> answer);
  void use_session(const std::string& name, Answer<std::string> answer);
  /// The one used last before this one.
  void resume_session(Answer<std::string> answer);
  void list_sessions(Answer<std::vector<SessionSummary>> answer);

  void add(const CameraObservation& observation);
  void add(const LidarObservation& observation);
  /// 10 times per second.
  void tick();

  /// Answers when the view is stored (its number), or, for one to be taken when the board is still, at once
  /// (nothing).
  void capture(bool at_once, Answer<std::optional<int>> answer);
  void set_automatic(bool on, Answer<std::string> answer);
  void pick(const std::string& lidar, int row, int column, double radius, Answer<std::string> answer);
  void drop(int view, Answer<std::string> answer);
  void solve(Answer<Calibration> answer);

  CaptureStatus status() const;
  const Calibration* calibration() const { return pipeline_ ? pipeline_->calibration() : nullptr; }
  std::int64_t solved_time() const { return solved_time_; }  ///< ns UTC, of calibration()
  const std::string& session() const { return session_; }    ///< directory; empty while none is open
  const std::string& storage_problem() const { return storage_problem_; }
  const std::set<int>& view_ids() const { return views_; }  ///< of the session
  bool solving() const { return !solver_.idle(); }
  const Rig& rig() const { return rig_; }
  StoreCost store_cost() const { return store_.cost(); }
  bool idle() const { return !writing_ && store_.idle(); }

 private:
  struct Waiting {  ///< for a solve of this number or later
    std::uint64_t number;
    Answer<Calibration> answer;
  };

  void open(std::function<void(Store::Answer<OpenSession>)> how, Answer<std::string> answer);
  void opened(OpenSession session);
  void solve_again();
  void resume();
  bool ready(std::string& why) const;
  CaptureActions perform(CaptureActions actions);
  void perform(const CaptureEvent& event);
  void perform(StoreView view);
  void perform(const SolveViews& request);
  void perform(const DropView& drop);
  void write();
  void written(Result<ViewSights> answer);
  void solved(std::uint64_t number, const Result<Calibration>& answer);
  void note_storage(const Error* error);
  void forget_waiting(const Error& why);

  EventLoop& loop_;
  std::function<std::int64_t()> now_;
  Listener listener_;
  Rig rig_;  ///< as sessions keep it
  CaptureOptions options_;
  std::unique_ptr<CapturePipeline> pipeline_;   ///< nothing until a session is open
  std::unique_ptr<CapturePipeline> suspended_;  ///< of the session before, while another is being opened
  std::string session_;
  std::set<int> views_;         ///< stored and not dropped
  std::uint64_t opening_ = 0;   ///< number of the opening under way or done
  bool retry_opening_ = false;  ///< at the next retry_at_
  std::shared_ptr<StoreView> writing_;
  bool retry_writing_ = false;
  std::vector<int> dropping_;  ///< removals to be tried again
  std::int64_t retry_at_ = 0;  ///< ns
  std::string storage_problem_;
  std::int64_t solved_time_ = 0;
  std::map<int, std::vector<Answer<std::optional<int>>>> waiting_for_view_;
  std::vector<Waiting> waiting_for_solve_;
  Store store_;
  JobThread solver_;
};

}  // namespace ca2
