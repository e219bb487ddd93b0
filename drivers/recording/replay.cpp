#include "drivers/recording/replay.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/capture/solve_views.h"
#include "core/capture/store_view.h"
#include "core/features/extract.h"
#include "core/io/files.h"
#include "drivers/net/pacer.h"
#include "drivers/recording/ordered_detection.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t tick_period = 200'000'000;  // ns: what the pipeline asks for

class Host {
 public:
  Host(const Rig& rig, Session& session, const ReplayOptions& options, std::vector<ViewSights> views)
      : session_(session), options_(options), pipeline_(rig, options.capture, std::move(views)) {}

  void add(std::int64_t now, const SearchedFrame& frame) {
    // Time passes in steps: the first frame begins it.
    for (std::int64_t time = now_ + tick_period; now_ != 0 && time < now; time += tick_period)
      handle(time, pipeline_.tick(time));
    now_ = now;
    std::visit([&](const auto& observation) { handle(now, pipeline_.add(observation)); }, frame.observation);
    if (options_.progress) options_.progress(pipeline_, now);
  }

  ReplayReport report;
  std::optional<Error> error;  ///< the first view's that could not be stored

 private:
  void handle(std::int64_t now, CaptureActions actions) {
    for (CaptureAction& action : actions) {
      if (auto* view = std::get_if<StoreView>(&action)) {
        handle(now, pipeline_.stored(now, view->id, store(now, *view)));
      } else if (const auto* request = std::get_if<SolveViews>(&action)) {
        handle(now, pipeline_.solved(now, request->number, solve_views(*request)));
      } else if (const auto* drop = std::get_if<DropView>(&action)) {
        remove(drop->id);
      } else if (const auto* event = std::get_if<CaptureEvent>(&action)) {
        if (options_.event) options_.event(*event);
      }
    }
  }

  Result<ViewSights> store(std::int64_t now, StoreView& view) {
    const std::size_t before = session_.views.size();
    Result<ViewSights> sights = store_view(session_, view);
    if (session_.views.size() > before) {
      report.stored[view.id] = now;
    } else {
      ++report.failed;
      if (!error) error = sights.error();
    }
    return sights;
  }

  /// What was stored was not good enough after all.
  void remove(int id) {
    const auto has_id = [&](const SessionView& view) { return view.id == id; };
    const auto view = std::find_if(session_.views.begin(), session_.views.end(), has_id);
    if (view == session_.views.end()) return;
    if (const auto removed = remove_view(*view); !removed && !error) error = removed.error();
    session_.views.erase(view);
    report.stored.erase(id);
  }

  Session& session_;
  const ReplayOptions& options_;
  CapturePipeline pipeline_;
  std::int64_t now_ = 0;
};

/// What was found in the views that the session has.
Result<std::vector<ViewSights>> views_of(const Session& session) {
  std::vector<ViewSights> views;
  for (const SessionView& view : session.views) {
    Result<ViewSights> sights = extract_view(session, view.id);
    // A damaged view is the solve's to report.
    if (sights) views.push_back(std::move(*sights));
  }
  return views;
}

}  // namespace

Result<ReplayReport> replay(const Rig& rig, RecordingReader& reader, Session& session,
                            const ReplayOptions& options) {
  auto views = views_of(session);
  if (!views) return fail(views.error());
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  OrderedDetection detection(rig, reader, options.threads > 0 ? options.threads : cores);
  Host host(rig, session, options, std::move(*views));
  Pacer pacer(options.speed);
  while (const std::unique_ptr<SearchedFrame> frame = detection.next()) {
    const auto now = Clock::now();
    std::this_thread::sleep_for(
        std::chrono::nanoseconds(pacer.wait(frame->arrival, now.time_since_epoch().count())));
    host.add(frame->arrival, *frame);
  }
  if (host.report.stored.empty() && host.error) return fail(*host.error);
  return host.report;
}

Result<Session> session_of(const Recording& recording, const std::filesystem::path& directory) {
  std::error_code ignored;
  Rig rig = recording.rig;
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  for (auto& [name, lidar] : rig.lidars) {
    for (std::string* file : {&lidar.metadata, &lidar.calibration}) {
      if (file->empty()) continue;
      const std::filesystem::path source = recording.directory / *file;
      Result<std::string> content = read_text(source);
      if (!content) return fail(content.error());
      *file = name + source.extension().string();
      files.emplace_back(directory / *file, std::move(*content));
    }
  }
  if (std::filesystem::exists(directory / "session.yaml", ignored)) {
    Result<Session> session = open_session(directory);
    if (session && write_rig(session->rig) != write_rig(rig)) {
      return fail(ErrorCode::config, directory.string(), "is a session of another rig than the recording's",
                  "choose another directory");
    }
    return session;
  }
  Result<Session> session = create_session(directory, rig);
  for (const auto& [path, content] : files) {
    if (!session) break;
    if (const auto written = write_atomically(path, content); !written) return fail(written.error());
  }
  return session;
}

}  // namespace ca2
