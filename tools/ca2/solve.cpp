/// @file `ca2 solve`: from a session to its result.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/ca2/command.h"
#include "tools/ca2/daemon_link.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/print_calibration.h"
#include "tools/ca2/solve_session.h"

namespace ca2 {
namespace {

/// The daemon solves its session, with all of its views, and writes the result there.
Result<int> solve_in_daemon(const DaemonAddress& daemon, bool as_json) {
  constexpr std::chrono::minutes patience{5};
  const auto reply = call_daemon(daemon, "solve", nlohmann::json::object(), patience);
  if (!reply) {
    Error error = reply.error();
    if (error.code == ErrorCode::unavailable) {
      error.problems.back().hint += "; without a daemon: `ca2 solve SESSION`";
    }
    return fail(std::move(error));
  }
  if (as_json) {
    std::printf("%s\n", reply->at("result").dump(2).c_str());
    return 0;
  }
  const Result<Calibration> calibration = parse_calibration(reply->at("yaml"), "the daemon's answer");
  if (!calibration) return fail(calibration.error());
  std::printf("%swritten to %s\n", describe(*calibration).c_str(),
              reply->at("file").get<std::string>().c_str());
  return 0;
}

Result<int> solve(const SolveArguments& arguments, const DaemonAddress& daemon) {
  if (arguments.held.any() && arguments.method != "joint") {
    return fail(ErrorCode::usage, "--hold", "the published methods hold everything that is given",
                "leave it out, or --method");
  }
  if (!arguments.session.empty()) return solve_session(arguments);
  const bool as_ever = arguments.output.empty() && arguments.views.empty() && arguments.method == "joint" &&
                       arguments.best == 0 && !arguments.held.any();
  if (as_ever) return solve_in_daemon(daemon, arguments.json);
  return fail(ErrorCode::usage, "",
              "--output, --views, --best, --hold and --method are for a session on the disk",
              "name it: `ca2 solve SESSION ...`");
}

}  // namespace

CommandBody setup_solve(CLI::App& app) {
  auto arguments = std::make_shared<SolveArguments>();
  auto daemon = std::make_shared<DaemonAddress>();
  app.add_option("session", arguments->session, "Session directory; without it: the daemon's");
  add_daemon_options(app, *daemon);
  app.add_option("--output,-o", arguments->output, "Result file (default: SESSION/result.yaml)");
  app.add_option(
         "--method", arguments->method,
         "joint: maximum likelihood over corners and ranges; plane_to_plane and kim: the published methods")
      ->check(CLI::IsMember({"joint", "plane_to_plane", "kim"}))
      ->capture_default_str();
  app.add_option("--views", arguments->views, "Use these views only, like 1,4,7-9");
  app.add_option("--best", arguments->best,
                 "Use only the so many views that together determine the answer best")
      ->check(number_in(3, 100000));
  app.add_option_function<std::vector<std::string>>(
         "--hold",
         [arguments](const std::vector<std::string>& names) {
           arguments->held = {std::ranges::count(names, "intrinsics") > 0,
                              std::ranges::count(names, "ranges") > 0};
         },
         "Take for exactly right, what was measured better than views can: given intrinsics, unbiased ranges")
      ->delimiter(',')
      ->check(CLI::IsMember({"intrinsics", "ranges"}));
  app.add_flag("--json", arguments->json, "Print the result as JSON");
  app.add_flag("--no-cache", arguments->no_cache, "Search every picture and cloud again, keep nothing");
  app.add_option("--threads", arguments->threads, "Threads for the search (default: one per core)")
      ->check(number_in(1, 256));
  app.footer(
      "Finds the board in every picture and cloud, calibrates all sensors of the rig at once and writes\n"
      "result.yaml with the covariance of every transform. Exit status 1 and no result when the views do\n"
      "not determine the answer: the message says which direction is weak, and how to hold the board to\n"
      "cure it.\n"
      "Given focal lengths and principal points are refined, a lens's distortion and the print's size where\n"
      "the views contradict them: the result has each with its sigma (0: held), and a note.\n"
      "What --hold takes for right makes few views as precise as many, if it is right: where the views\n"
      "contradict it, a note says so and the verdict is weak.");
  return [arguments, daemon] { return solve(*arguments, *daemon); };
}

}  // namespace ca2
