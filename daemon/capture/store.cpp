#include "daemon/capture/store.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "core/capture/store_view.h"
#include "core/features/extract.h"
#include "core/features/result_inputs.h"
#include "core/io/files.h"
#include "daemon/config/check_sources.h"
#include "daemon/log.h"
#include "drivers/camera/host_time.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_jobs = 64;
constexpr std::chrono::seconds longest_job{300};  // a session of a thousand views without its cache

/// Two rigs are one where only the way to the sensors differs.
bool same_rig(Rig a, Rig b) {
  for (Rig* rig : {&a, &b}) {
    for (auto& [name, camera] : rig->cameras) camera.source.clear();
    for (auto& [name, lidar] : rig->lidars) lidar.source.clear();
  }
  return write_rig(a) == write_rig(b);
}

std::string time_text(const char* format) {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[64];
  return {text, std::strftime(text, sizeof(text), format, &parts)};
}

std::int64_t utc_of_file(const fs::path& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  if (error) return 0;
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::file_clock::to_sys(time).time_since_epoch())
      .count();
}

SessionSummary summarise(const fs::path& directory, const Rig& rig) {
  SessionSummary summary;
  summary.name = directory.filename().string();
  summary.changed = utc_of_file(directory / "views");
  const Result<Session> session = open_session(directory);
  if (!session) {
    summary.problem = session.error().problems.front().what;
    return summary;
  }
  std::error_code error;
  summary.views = static_cast<int>(session->views.size());
  summary.solved = fs::exists(directory / "result.yaml", error);
  summary.fits = same_rig(session->rig, rig);
  return summary;
}

tl::unexpected<Error> no_such_session(const std::string& name) {
  return fail(ErrorCode::usage, "", "there is no session '" + name + "'", "`ca2 session list` shows them");
}

/// Views that were written while it was solved are none that the answer was made of.
Session with_views_of(Session session, const Calibration& answer) {
  std::erase_if(session.views, [&](const SessionView& view) {
    const auto is_it = [&](const CalibratedView& solved) { return solved.id == view.id; };
    return std::none_of(answer.views.begin(), answer.views.end(), is_it);
  });
  return session;
}

/// s of a CPU that this thread has had.
double thread_cpu() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Rig session_rig(const Rig& rig, const fs::path& file) {
  Rig out = rig;
  for (auto& [name, lidar] : out.lidars) {
    for (std::string* path : {&lidar.metadata, &lidar.calibration}) {
      if (!path->empty()) *path = fs::absolute(resolve(*path, file)).string();
    }
  }
  return out;
}

Store::Store(EventLoop& loop, Heartbeats& heartbeats, fs::path state)
    : loop_(loop), state_(std::move(state)), thread_("writer", heartbeats, most_jobs, longest_job) {}

template <class Value>
void Store::run(std::function<Result<Value>()> job, Answer<Value> answer) {
  const bool taken = thread_.submit([this, job = std::move(job), answer] {
    auto result = std::make_shared<Result<Value>>(job());
    loop_.post([result, answer] { answer(std::move(*result)); });
  });
  if (!taken) answer(fail(ErrorCode::unavailable, state_.string(), "the disk cannot keep up"));
}

Result<OpenSession> Store::open(const std::string& name, const Rig& rig) {
  const fs::path directory = state_ / "sessions" / name;
  Result<Session> session = open_session(directory);
  if (!session) return fail(session.error());
  if (!same_rig(session->rig, rig)) {
    return fail(ErrorCode::config, directory.string(), "the session was made with another rig",
                "`ca2 session new` begins one with the rig of ca2d.yaml");
  }
  for (const Problem& warning : session->warnings) {
    log::warning("store", Error(ErrorCode::data, warning.where, warning.what, warning.hint).text());
  }
  OpenSession out{directory, session->rig, {}};
  for (const SessionView& view : session->views) {
    Result<ViewSights> sights = extract_view(*session, view.id);
    if (sights) {
      out.views.push_back(std::move(*sights));
    } else {
      log::warning("store", sights.error().text());
    }
  }
  if (const auto written = write_atomically(state_ / "current", name + "\n"); !written) {
    return fail(written.error());
  }
  session_ = std::move(*session);
  return out;
}

Result<OpenSession> Store::make(const Rig& rig, std::string name) {
  std::error_code error;
  const fs::path sessions = state_ / "sessions";
  fs::create_directories(sessions, error);
  if (error)
    return fail(ErrorCode::cannot_create, sessions.string(), "cannot be created: " + error.message());
  if (name.empty()) {
    const std::string time = name = time_text("%Y%m%dT%H%M%SZ");
    for (int i = 2; fs::exists(sessions / name, error); ++i) name = time + "-" + std::to_string(i);
  }
  const Result<Session> made = create_session(sessions / name, rig, time_text("%Y-%m-%dT%H:%M:%SZ"));
  if (!made) return fail(made.error());
  if (const auto synced = sync_directory(sessions); !synced) return fail(synced.error());
  return open(name, rig);
}

void Store::resume(const Rig& rig, Answer<OpenSession> answer) {
  run<OpenSession>(
      [this, rig]() -> Result<OpenSession> {
        const Result<std::string> current = read_text(state_ / "current", 1024);
        const std::string name = current ? current->substr(0, current->find('\n')) : "";
        if (valid_sensor_name(name)) {
          Result<OpenSession> session = open(name, rig);
          // Any other failure is one of the disk, and is tried again: a new session would hide the views.
          const bool gone = !fs::exists(state_ / "sessions" / name / "session.yaml");
          if (session || (session.error().code != ErrorCode::config && !gone)) return session;
          log::warning("store", session.error().text() + "; a new session is begun");
        }
        return make(rig, {});
      },
      std::move(answer));
}

void Store::create(const Rig& rig, const std::string& name, Answer<OpenSession> answer) {
  if (!name.empty() && !valid_sensor_name(name)) {
    return answer(fail(ErrorCode::usage, "", "a session's name is 1 to 64 letters, digits, '_' and '-'"));
  }
  run<OpenSession>([this, rig, name] { return make(rig, name); }, std::move(answer));
}

void Store::use(const Rig& rig, const std::string& name, Answer<OpenSession> answer) {
  run<OpenSession>(
      [this, rig, name]() -> Result<OpenSession> {
        std::error_code error;
        if (!valid_sensor_name(name) || !fs::exists(state_ / "sessions" / name, error)) {
          return no_such_session(name);
        }
        return open(name, rig);
      },
      std::move(answer));
}

void Store::list(const Rig& rig, Answer<std::vector<SessionSummary>> answer) {
  run<std::vector<SessionSummary>>(
      [this, rig]() -> Result<std::vector<SessionSummary>> {
        std::vector<SessionSummary> sessions;
        std::error_code error;
        for (fs::directory_iterator at(state_ / "sessions", error), end; !error && at != end;
             at.increment(error)) {
          if (valid_sensor_name(at->path().filename().string())) sessions.push_back(summarise(*at, rig));
        }
        std::sort(sessions.begin(), sessions.end(),
                  [](const auto& a, const auto& b) { return a.changed > b.changed; });
        return sessions;
      },
      std::move(answer));
}

Result<ViewSights> Store::store(StoreView& view) {
  StoreCost cost{1, 0, 0};
  double begin = thread_cpu();
  double* current = &cost.saving;
  const auto step = [&](StoreStep next) {
    const double now = thread_cpu();
    *current += now - std::exchange(begin, now);
    current = next == StoreStep::saving ? &cost.saving : &cost.searching;
  };
  Result<ViewSights> sights = store_view(session_, view, step);
  step(StoreStep::saving);
  if (!sights) return sights;
  const std::lock_guard lock(cost_mutex_);
  cost_.views += cost.views;
  cost_.saving += cost.saving;
  cost_.searching += cost.searching;
  return sights;
}

StoreCost Store::cost() const {
  const std::lock_guard lock(cost_mutex_);
  return cost_;
}

void Store::write(std::shared_ptr<StoreView> view, Answer<ViewSights> answer) {
  run<ViewSights>(
      [this, view]() -> Result<ViewSights> {
        const auto same = [&](const SessionView& other) { return other.id == view->id; };
        const bool written = std::any_of(session_.views.begin(), session_.views.end(), same);
        Result<ViewSights> sights = written ? extract_view(session_, view->id) : store(*view);
        // What the view took lies between pictures that come and go: the process would keep it for ever.
        ::malloc_trim(0);
        return sights;
      },
      std::move(answer));
}

void Store::remove(int view, Answer<bool> answer) {
  run<bool>(
      [this, view]() -> Result<bool> {
        const auto found = std::find_if(session_.views.begin(), session_.views.end(),
                                        [&](const SessionView& other) { return other.id == view; });
        if (found == session_.views.end()) return true;
        if (const auto removed = remove_view(*found); !removed) return fail(removed.error());
        session_.views.erase(found);
        return true;
      },
      std::move(answer));
}

void Store::write_result(const Calibration* calibration, Answer<bool> answer) {
  run<bool>(
      [this, result = calibration ? std::optional(*calibration) : std::nullopt]() mutable -> Result<bool> {
        const fs::path file = session_.directory / "result.yaml";
        std::error_code error;
        if (result) {
          result->inputs = result_inputs(with_views_of(session_, *result), {});
          const auto written = write_atomically(file, to_yaml(*result));
          return written ? Result<bool>(true) : Result<bool>(fail(written.error()));
        }
        fs::rename(file, session_.directory / "result.previous.yaml", error);
        if (!error || error == std::errc::no_such_file_or_directory) return true;
        return fail(ErrorCode::io, file.string(), "cannot be set aside: " + error.message());
      },
      std::move(answer));
}

}  // namespace ca2
