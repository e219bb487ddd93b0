/// @file `ca2 solve`: from a session to its result.
#include <CLI/CLI.hpp>
#include <memory>

#include "tools/ca2/command.h"
#include "tools/ca2/solve_session.h"

namespace ca2 {
namespace {

Result<int> solve(const SolveArguments& arguments) {
  if (arguments.session.empty()) {
    return fail(ErrorCode::unavailable, "", "no daemon is running here",
                "name the session: `ca2 solve SESSION`");
  }
  return solve_session(arguments);
}

}  // namespace

CommandBody setup_solve(CLI::App& app) {
  auto arguments = std::make_shared<SolveArguments>();
  app.add_option("session", arguments->session, "Session directory");
  app.add_option("--output,-o", arguments->output, "Result file (default: SESSION/result.yaml)");
  app.add_option(
         "--method", arguments->method,
         "joint: maximum likelihood over corners and ranges; plane_to_plane and kim: the published methods")
      ->check(CLI::IsMember({"joint", "plane_to_plane", "kim"}))
      ->capture_default_str();
  app.add_option("--views", arguments->views, "Use these views only, like 1,4,7-9");
  app.add_option("--best", arguments->best,
                 "Use only the so many views that together determine the answer best")
      ->check(CLI::Range(3, 100000));
  app.add_flag("--json", arguments->json, "Print the result as JSON");
  app.add_flag("--no-cache", arguments->no_cache, "Search every picture and cloud again, keep nothing");
  app.add_option("--threads", arguments->threads, "Threads for the search (default: one per core)")
      ->check(CLI::Range(1, 256));
  app.footer(
      "Finds the board in every picture and cloud, calibrates all sensors of the rig at once and writes "
      "result.yaml\n"
      "with the covariance of every transform. Exit status 1 and no result when the views cannot determine "
      "the\n"
      "answer: the message says which direction is weak and how to hold the board to cure it.");
  return [arguments] { return solve(*arguments); };
}

}  // namespace ca2
