/// @file `ca2 solve`: from a session to its result.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/features/extract.h"
#include "core/io/files.h"
#include "core/session/session.h"
#include "core/solve/calibrate.h"
#include "tools/ca2/command.h"
#include "tools/ca2/id_list.h"
#include "tools/ca2/print_calibration.h"
#include "tools/ca2/progress.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

struct SolveArguments {
  std::string session;
  std::string output;
  std::string method = "joint";
  std::string views;
  bool json = false;
  bool no_cache = false;
  int threads = 0;
};

/// They do not stop the solve: it does without what they are about.
void print_warnings(const std::vector<Problem>& problems) {
  for (const Problem& problem : problems) {
    const Error line(ErrorCode::data, problem.where, "warning: " + problem.what, problem.hint);
    std::fprintf(stderr, "ca2: %s\n", line.text().c_str());
  }
}

/// A refused solve must not leave the result of an earlier one in place as if it were the answer.
void set_aside(const std::filesystem::path& output) {
  std::error_code error;
  if (!std::filesystem::exists(output, error)) return;
  const std::filesystem::path aside = output.parent_path() / (output.stem().string() + ".previous.yaml");
  std::filesystem::rename(output, aside, error);
  if (!error) std::fprintf(stderr, "ca2: the earlier result is now %s\n", aside.string().c_str());
}

/// Simulated sessions say what is true: then the error is measured, not only estimated.
void print_true_errors(const Session& session, const Calibration& calibration) {
  const std::filesystem::path file = session.directory / "truth.yaml";
  if (!std::filesystem::exists(file)) return;
  const Result<std::vector<TrueTransform>> truth = read_true_transforms(file);
  if (!truth) return print_warnings(truth.error().problems);
  for (const TrueTransform& real : *truth) {
    for (const CalibratedTransform& found : calibration.transforms) {
      if (found.parent != real.parent || found.child != real.child) continue;
      const Vector6d error = found.T_parent_child.difference(real.T_parent_child);
      std::printf("true error of T_%s_%s: %.2f mm, %.2f mrad (truth.yaml)\n", real.parent.c_str(),
                  real.child.c_str(), 1e3 * error.tail<3>().norm(), 1e3 * error.head<3>().norm());
    }
  }
}

Result<int> solve(const SolveArguments& arguments) {
  if (arguments.session.empty()) {
    return fail(ErrorCode::unavailable, "", "no daemon is running here",
                "name the session: `ca2 solve SESSION`");
  }
  ExtractOptions extract;
  extract.cache = !arguments.no_cache;
  extract.threads = arguments.threads;
  if (!arguments.views.empty()) {
    Result<std::vector<int>> ids = parse_id_list(arguments.views);
    if (!ids) return fail(ids.error());
    extract.views = std::move(*ids);
  }
  const Result<Session> session = open_session(arguments.session);
  if (!session) return fail(session.error());
  print_warnings(session->warnings);

  Progress progress("finding the board");
  extract.progress = [&](int done, int total) { progress.show(done, total); };
  const Result<Extraction> features = extract_features(*session, extract);
  const std::filesystem::path output =
      arguments.output.empty() ? session->directory / "result.yaml" : std::filesystem::path(arguments.output);
  if (!features) {
    if (features.error().code == ErrorCode::refused) set_aside(output);
    return fail(features.error());
  }
  print_warnings(features->problems);

  CalibrateOptions options;
  options.method = arguments.method == "kim"              ? Method::kim
                   : arguments.method == "plane_to_plane" ? Method::plane_to_plane
                                                          : Method::joint;
  options.estimated = features->estimated;
  const Result<Calibration> calibration = calibrate(features->rig, features->views, options);
  if (!calibration) {
    set_aside(output);
    return fail(calibration.error());
  }
  const Result<void> written = write_atomically(output, to_yaml(*calibration));
  if (!written) return fail(written.error());
  if (arguments.json) {
    std::printf("%s\n", to_json(*calibration).c_str());
  } else {
    std::printf("%s", describe(*calibration).c_str());
    print_true_errors(*session, *calibration);
    std::printf("written to %s\n", output.string().c_str());
  }
  return 0;
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
