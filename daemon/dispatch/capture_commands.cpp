/// @file Commands about views and the answer.
#include <cmath>
#include <nlohmann/json.hpp>

#include "daemon/capture/capture_host.h"
#include "daemon/dispatch/arguments.h"
#include "daemon/dispatch/commands.h"
#include "messages/status.h"

namespace ca2 {
namespace {

using nlohmann::json;

constexpr long long most_rows = 1000, most_columns = 100'000;
constexpr double largest_radius = 1000;  // px

/// Passes on a text as {"text": ...}.
std::function<void(Result<std::string>)> as_text(CommandAnswer answer) {
  return [answer = std::move(answer)](Result<std::string> text) {
    answer(text ? Result<json>(json{{"text", *text}}) : fail(text.error()));
  };
}

}  // namespace

void answer_status(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  if (const auto good = Arguments(arguments).done(); !good) return answer(fail(good.error()));
  answer(to_json(targets.status()));
}

void answer_capture(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const bool now = given.flag("now", false);
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  targets.capture.capture(now, [answer](const Result<std::optional<int>>& view) {
    if (!view) return answer(fail(view.error()));
    answer(json{{"view", *view ? json(**view) : json(nullptr)}});
  });
}

void answer_auto(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const bool on = given.flag("on");
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  targets.capture.set_automatic(on, as_text(std::move(answer)));
}

void answer_pick(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const std::string lidar = given.text("lidar");
  const auto row = static_cast<int>(given.integer("row", 0, most_rows));
  const auto column = static_cast<int>(given.integer("column", 0, most_columns));
  const double radius = given.number("radius", 0, largest_radius, 0);
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  targets.capture.pick(lidar, row, column, radius, as_text(std::move(answer)));
}

void answer_views(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  if (const auto good = Arguments(arguments).done(); !good) return answer(fail(good.error()));
  const Calibration* calibration = targets.capture.calibration();
  json views = json::array();
  for (const int id : targets.capture.view_ids()) {
    json view{
        {"id", id}, {"used", nullptr}, {"reason", ""}, {"reprojection_rms", nullptr}, {"plane_rms", nullptr}};
    if (calibration) {
      for (const CalibratedView& solved : calibration->views) {
        if (solved.id != id) continue;
        view["used"] = solved.used;
        view["reason"] = solved.reason;
        if (std::isfinite(solved.reprojection_rms)) view["reprojection_rms"] = solved.reprojection_rms;
        if (std::isfinite(solved.plane_rms)) view["plane_rms"] = solved.plane_rms;
      }
    }
    views.push_back(std::move(view));
  }
  answer(json{{"session", targets.capture.session()}, {"views", std::move(views)}});
}

void answer_drop(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  Arguments given(arguments);
  const auto view = static_cast<int>(given.integer("view", 0, 1'000'000'000));
  if (const auto good = given.done(); !good) return answer(fail(good.error()));
  targets.capture.drop(view, as_text(std::move(answer)));
}

void answer_drop_last(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  if (const auto good = Arguments(arguments).done(); !good) return answer(fail(good.error()));
  const std::set<int>& views = targets.capture.view_ids();
  if (views.empty()) return answer(fail(ErrorCode::usage, "", "there are no views"));
  targets.capture.drop(*views.rbegin(), as_text(std::move(answer)));
}

void answer_solve(const CommandTargets& targets, const json& arguments, CommandAnswer answer) {
  if (const auto good = Arguments(arguments).done(); !good) return answer(fail(good.error()));
  targets.capture.solve(
      [answer, session = targets.capture.session()](const Result<Calibration>& calibration) {
        if (!calibration) return answer(fail(calibration.error()));
        answer(json{{"result", json::parse(to_json(*calibration))},
                    {"yaml", to_yaml(*calibration)},
                    {"file", session + "/result.yaml"}});
      });
}

}  // namespace ca2
