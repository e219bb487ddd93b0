/// @file Commands about sessions, recordings and previews.
#include <nlohmann/json.hpp>

#include "core/io/base64.h"
#include "daemon/capture/capture_host.h"
#include "daemon/dispatch/arguments.h"
#include "daemon/dispatch/commands.h"
#include "daemon/publish/preview_maker.h"
#include "daemon/record/recorder.h"

namespace ca2 {
namespace {

using nlohmann::json;

/// Passes on a directory as {key: directory}.
std::function<void(Result<std::string>)> as_directory(const char* key, CommandAnswer answer) {
  return [key, answer = std::move(answer)](Result<std::string> directory) {
    answer(directory ? Result<json>(json{{key, *directory}}) : fail(directory.error()));
  };
}

}  // namespace

void answer_session_new(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const std::string name = given.text("name", "");
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  targets.capture.new_session(name, as_directory("session", std::move(answer)));
}

void answer_session_use(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const std::string name = given.text("name");
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  targets.capture.use_session(name, as_directory("session", std::move(answer)));
}

void answer_session_resume(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  if (const auto good = Arguments(arguments).done(); !good) return answer(fail(good.error()));
  targets.capture.resume_session(as_directory("session", std::move(answer)));
}

void answer_session_list(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  if (const auto good = Arguments(arguments).done(); !good) return answer(fail(good.error()));
  const std::string current = std::filesystem::path(targets.capture.session()).filename().string();
  targets.capture.list_sessions([answer, current](const Result<std::vector<SessionSummary>>& sessions) {
    if (!sessions) return answer(fail(sessions.error()));
    json list = json::array();
    for (const SessionSummary& session : *sessions) {
      list.push_back({{"name", session.name},
                      {"views", session.views},
                      {"solved", session.solved},
                      {"fits", session.fits},
                      {"current", session.name == current},
                      {"changed", session.changed},
                      {"problem", session.problem}});
    }
    answer(json{{"sessions", std::move(list)}});
  });
}

void answer_record_start(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const std::string name = given.text("name", "");
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  const Result<std::string> directory = targets.recorder.start(name);
  if (!directory) return answer(fail(directory.error()));
  answer(json{{"recording", *directory}, {"caveat", targets.recorder.caveat()}});
}

void answer_record_stop(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  if (const auto good = Arguments(arguments).done(); !good) return answer(fail(good.error()));
  targets.recorder.stop([answer](const Result<RecordingSummary>& recording) {
    if (!recording) return answer(fail(recording.error()));
    answer(json{{"recording", recording->directory}, {"dropped", recording->dropped}});
  });
}

void answer_preview(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const std::string sensor = given.text("sensor");
  const auto width = static_cast<int>(given.integer("width", 16, 1280, 480));
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  targets.previews.make(sensor, width, [answer, sensor](const Result<Preview>& preview) {
    if (!preview) return answer(fail(preview.error()));
    answer(json{{"sensor", sensor},
                {"time", preview->time},
                {"width", preview->width},
                {"height", preview->height},
                {"sees_board", preview->sees_board},
                {"jpeg", to_base64(preview->jpeg)}});
  });
}

}  // namespace ca2
