#include "daemon/capture/capture_host.h"

#include <algorithm>

#include "core/capture/solve_views.h"
#include "core/types/counted.h"
#include "core/types/text.h"
#include "daemon/log.h"

namespace ca2 {
namespace {

constexpr std::int64_t retry_period = 1'000'000'000;  // ns: what the disk refused is tried again
constexpr std::chrono::seconds longest_solve{300};
constexpr int fewest_views = 3;  // fewer are not worth a solve

std::string last_event(const CaptureActions& actions) {
  std::string text;
  for (const CaptureAction& action : actions) {
    if (const auto* event = std::get_if<CaptureEvent>(&action)) text = event->text;
  }
  return text;
}

template <class Kind>
const Kind* find(const CaptureActions& actions) {
  for (const CaptureAction& action : actions) {
    if (const auto* found = std::get_if<Kind>(&action)) return found;
  }
  return nullptr;
}

bool rejected(const CaptureActions& actions) {
  const auto* event = find<CaptureEvent>(actions);
  return event && event->kind == "rejected";
}

}  // namespace

CaptureHost::CaptureHost(EventLoop& loop, Heartbeats& heartbeats, const Config& config,
                         std::function<std::int64_t()> now, Listener listener)
    : loop_(loop),
      now_(std::move(now)),
      listener_(std::move(listener)),
      store_(loop, heartbeats, config.options.state_directory),
      solver_("solver", heartbeats, 1, longest_solve) {
  restart(config);
}

void CaptureHost::restart(const Config& config) {
  rig_ = session_rig(config.rig, config.file);
  options_ = config.options.capture;
  pipeline_.reset();  // of the rig before
  resume();
}

void CaptureHost::resume() {
  open([this](auto answer) { store_.resume(rig_, std::move(answer)); },
       [this](const Result<std::string>& opened) {
         if (opened) return;
         note_storage(&opened.error());
         retry_opening_ = true;
       });
}

/// While it is under way there is no pipeline: a view that it made would belong to no session.
void CaptureHost::open(std::function<void(Store::Answer<OpenSession>)> how, Answer<std::string> answer) {
  const std::uint64_t number = ++opening_;
  retry_opening_ = false;
  if (pipeline_) suspended_ = std::move(pipeline_);
  how([this, number, answer](Result<OpenSession> session) {
    if (number != opening_) {
      return answer(fail(ErrorCode::unavailable, "", "another session was opened meanwhile"));
    }
    const std::string directory = session ? session->directory.string() : "";
    if (session) {
      opened(std::move(*session));
    } else if (suspended_) {
      pipeline_ = std::move(suspended_);
      solve_again();  // an answer that came meanwhile was not taken
    }
    answer(session ? Result<std::string>(directory) : fail(session.error()));
  });
}

void CaptureHost::solve_again() {
  if (pipeline_->status(now_()).views >= fewest_views) perform(pipeline_->solve(now_()));
}

void CaptureHost::opened(OpenSession session) {
  forget_waiting(Error(ErrorCode::unavailable, "", "another session was opened meanwhile"));
  suspended_.reset();
  writing_.reset();
  dropping_.clear();
  note_storage(nullptr);
  session_ = session.directory.string();
  views_.clear();
  for (const ViewSights& view : session.views) views_.insert(view.id);
  log::info("capture", "session " + session_ + ", " + counted(session.views.size(), "view"));
  pipeline_ = std::make_unique<CapturePipeline>(session.rig, options_, std::move(session.views));
  solve_again();
  listener_.changed();
}

bool CaptureHost::ready(std::string& why) const {
  if (!pipeline_) {
    why = storage_problem_.empty() ? "the session is being opened" : storage_problem_;
  } else if (writing_) {
    why = formatted("view %d is being written", writing_->id);
  } else {
    return true;
  }
  return false;
}

void CaptureHost::new_session(const std::string& name, Answer<std::string> answer) {
  std::string why;
  if (pipeline_ && !ready(why)) return answer(fail(ErrorCode::unavailable, "", why, "try again"));
  open([this, name](auto opened) { store_.create(rig_, name, std::move(opened)); }, std::move(answer));
}

void CaptureHost::use_session(const std::string& name, Answer<std::string> answer) {
  std::string why;
  if (pipeline_ && !ready(why)) return answer(fail(ErrorCode::unavailable, "", why, "try again"));
  open([this, name](auto opened) { store_.use(rig_, name, std::move(opened)); }, std::move(answer));
}

void CaptureHost::resume_session(Answer<std::string> answer) {
  list_sessions([this, answer](const Result<std::vector<SessionSummary>>& sessions) {
    if (!sessions) return answer(fail(sessions.error()));
    const std::string current = std::filesystem::path(session_).filename().string();
    for (const SessionSummary& session : *sessions) {
      if (session.fits && session.name != current) return use_session(session.name, answer);
    }
    answer(fail(ErrorCode::usage, "", "there is no earlier session of this rig",
                "`ca2 session list` shows all"));
  });
}

void CaptureHost::list_sessions(Answer<std::vector<SessionSummary>> answer) {
  store_.list(rig_, std::move(answer));
}

void CaptureHost::add(const CameraObservation& observation) {
  if (pipeline_) perform(pipeline_->add(observation));
}

void CaptureHost::add(const LidarObservation& observation) {
  if (pipeline_) perform(pipeline_->add(observation));
}

void CaptureHost::tick() {
  const std::int64_t now = now_();
  if (pipeline_) perform(pipeline_->tick(now));
  if (now - retry_at_ < retry_period && now >= retry_at_) return;
  retry_at_ = now;
  if (retry_opening_) resume();
  if (retry_writing_) write();
  for (const int view : std::exchange(dropping_, {})) perform(DropView{view});
}

CaptureActions CaptureHost::perform(CaptureActions actions) {
  for (CaptureAction& action : actions) {
    if (auto* view = std::get_if<StoreView>(&action)) {
      StoreView taken = std::move(*view);
      view->id = taken.id;  // what the caller still looks at
      perform(std::move(taken));
    } else {
      std::visit(
          [this](const auto& one) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(one)>, StoreView>) perform(one);
          },
          action);
    }
  }
  if (!actions.empty()) listener_.changed();
  return actions;
}

void CaptureHost::perform(const CaptureEvent& event) {
  log::info("capture", event.kind + ": " + event.text);
  listener_.event(event);
}

void CaptureHost::perform(StoreView view) {
  writing_ = std::make_shared<StoreView>(std::move(view));
  write();
}

void CaptureHost::write() {
  retry_writing_ = false;
  store_.write(writing_, [this, view = writing_](Result<ViewSights> answer) {
    if (view == writing_) written(std::move(answer));
  });
}

/// A view is not given up because the disk is full: it stays in memory, nothing else is captured, and as soon
/// as there is room it is stored.
void CaptureHost::written(Result<ViewSights> answer) {
  const int id = writing_->id;
  if (!answer && answer.error().code != ErrorCode::data && answer.error().code != ErrorCode::internal) {
    note_storage(&answer.error());
    retry_writing_ = true;
    return;
  }
  note_storage(nullptr);
  writing_.reset();
  const auto waiting = waiting_for_view_.extract(id);
  if (!answer) {
    store_.remove(id, [](const Result<bool>&) {});  // of no use to anybody
    const Error error = answer.error();
    perform(pipeline_->stored(now_(), id, fail(error)));
    if (waiting) {
      for (const auto& one : waiting.mapped()) one(fail(error));
    }
    return;
  }
  views_.insert(id);
  const CaptureActions actions = perform(pipeline_->stored(now_(), id, std::move(answer)));
  const bool kept = views_.count(id) > 0;  // what turns out blurred is taken back at once
  if (kept) listener_.view(id, true);
  if (!waiting) return;
  for (const auto& one : waiting.mapped()) {
    one(kept ? Result<std::optional<int>>(id) : fail(ErrorCode::refused, "", last_event(actions)));
  }
}

void CaptureHost::perform(const DropView& drop) {
  views_.erase(drop.id);
  store_.remove(drop.id, [this, id = drop.id, session = session_](const Result<bool>& removed) {
    if (session != session_) return;
    note_storage(removed ? nullptr : &removed.error());
    if (!removed) dropping_.push_back(id);
    if (removed) listener_.view(id, false);
  });
}

void CaptureHost::perform(const SolveViews& request) {
  solver_.replace([this, request, opening = opening_](const std::stop_token& stop) {
    auto answer = std::make_shared<Result<Calibration>>(solve_views(request, stop));
    if (stop.stop_requested()) return;  // the newer one's answer counts
    loop_.post([this, number = request.number, answer, opening] {
      if (opening == opening_) solved(number, *answer);
    });
  });
}

void CaptureHost::solved(std::uint64_t number, const Result<Calibration>& answer) {
  solved_time_ = now_();
  perform(pipeline_->solved(solved_time_, number, answer));
  store_.write_result(pipeline_->calibration(), [this](const Result<bool>& written) {
    if (!written || !writing_) note_storage(written ? nullptr : &written.error());
  });
  std::vector<Waiting> waiting;
  waiting.swap(waiting_for_solve_);
  for (Waiting& one : waiting) {
    if (one.number <= number) {
      one.answer(answer);
    } else {
      waiting_for_solve_.push_back(std::move(one));
    }
  }
}

void CaptureHost::capture(bool at_once, Answer<std::optional<int>> answer) {
  std::string why;
  if (!ready(why)) return answer(fail(ErrorCode::unavailable, "", why, "try again"));
  const CaptureActions actions = perform(pipeline_->capture(now_(), at_once));
  if (const auto* view = find<StoreView>(actions)) {
    waiting_for_view_[view->id].push_back(std::move(answer));
  } else if (at_once) {
    answer(fail(ErrorCode::refused, "", last_event(actions)));
  } else {
    answer(std::optional<int>());
  }
}

void CaptureHost::set_automatic(bool on, Answer<std::string> answer) {
  options_.automatic = on;
  if (!pipeline_) return answer(on ? "captures by itself" : "captures when asked");
  answer(last_event(perform(pipeline_->set_automatic(now_(), on))));
}

void CaptureHost::pick(const std::string& lidar, int row, int column, double radius,
                       Answer<std::string> answer) {
  std::string why;
  if (!pipeline_ && !ready(why)) return answer(fail(ErrorCode::unavailable, "", why, "try again"));
  const auto entry = rig_.lidars.find(lidar);
  if (entry == rig_.lidars.end()) {
    return answer(fail(ErrorCode::usage, "", "the rig has no lidar '" + lidar + "'"));
  }
  const int index = static_cast<int>(std::distance(rig_.lidars.begin(), entry));
  const CaptureActions actions = perform(pipeline_->pick(now_(), index, row, column, radius));
  if (rejected(actions)) return answer(fail(ErrorCode::refused, "", last_event(actions)));
  answer(last_event(actions));
}

void CaptureHost::drop(int view, Answer<std::string> answer) {
  std::string why;
  if (!pipeline_ && !ready(why)) return answer(fail(ErrorCode::unavailable, "", why, "try again"));
  const CaptureActions actions = perform(pipeline_->drop(now_(), view));
  if (!find<DropView>(actions)) return answer(fail(ErrorCode::usage, "", last_event(actions)));
  answer(last_event(actions));
}

void CaptureHost::solve(Answer<Calibration> answer) {
  std::string why;
  if (!pipeline_ && !ready(why)) return answer(fail(ErrorCode::unavailable, "", why, "try again"));
  const CaptureActions actions = perform(pipeline_->solve(now_()));
  const auto* request = find<SolveViews>(actions);
  if (!request) return answer(fail(ErrorCode::refused, "", last_event(actions)));
  waiting_for_solve_.push_back({request->number, std::move(answer)});
}

CaptureStatus CaptureHost::status() const {
  if (pipeline_) return pipeline_->status(now_());
  CaptureStatus status;
  status.reason = "the session is being opened";
  status.automatic = options_.automatic;
  for (const auto& [name, camera] : rig_.cameras) status.sensors.push_back({name, true});
  for (const auto& [name, lidar] : rig_.lidars) status.sensors.push_back({name, false});
  status.target_translation = options_.target_sigma_translation;
  status.target_rotation = options_.target_sigma_rotation;
  return status;
}

/// Said once when it begins and once when it is over.
void CaptureHost::note_storage(const Error* error) {
  const std::string text = error ? error->text() : "";
  if (text == storage_problem_) return;
  if (text.empty()) {
    log::info("store", "writing works again");
  } else {
    log::error("store", text + "; it is tried again every second");
  }
  storage_problem_ = text;
  listener_.changed();
}

void CaptureHost::forget_waiting(const Error& why) {
  for (auto& [view, answers] : std::exchange(waiting_for_view_, {})) {
    for (const auto& answer : answers) answer(fail(why));
  }
  for (const Waiting& one : std::exchange(waiting_for_solve_, {})) one.answer(fail(why));
}

}  // namespace ca2
