#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "tools/ca2/command.h"
#include "tools/sim/session_writer.h"

namespace ca2 {
namespace {

struct Options {
  std::string scenario;
  std::string output;
  bool session = false;
  bool recording = false;
  std::optional<std::uint64_t> seed;
  std::optional<int> views;
};

Result<int> simulate(const Options& options) {
  if (options.recording) {
    return fail(ErrorCode::usage, "", "recordings cannot be simulated: there is no encoder of LiDAR packets",
                "use --session");
  }
  Result<ScenarioFile> scenario = read_scenario(options.scenario);
  if (!scenario) return fail(scenario.error());
  if (options.seed) scenario->scenario.seed = *options.seed;
  if (options.views) scenario->scenario.views = *options.views;
  const bool terminal = isatty(STDERR_FILENO) == 1;
  const auto progress = [&](int done, int all) {
    if (terminal) std::fprintf(stderr, "\rsimulating view %d of %d%s", done, all, done == all ? "\n" : "");
  };
  const Result<void> written = write_simulated_session(*scenario, options.output, progress);
  if (!written) return fail(written.error());
  return 0;
}

}  // namespace

CommandBody setup_simulate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("scenario", options->scenario, "Scenario file (docs/simulator.md)")
      ->required()
      ->type_name("SCENARIO.yaml");
  app.add_option("--output", options->output, "Directory to create")->required()->type_name("DIR");
  CLI::Option* session = app.add_flag("--session", options->session, "Write a session (the default)");
  app.add_flag("--recording", options->recording, "Write raw packets and pictures")->excludes(session);
  app.add_option("--seed", options->seed, "Instead of the scenario's seed")->type_name("N");
  app.add_option("--views", options->views, "Instead of the scenario's number of views")
      ->type_name("N")
      ->check(CLI::Range(1, 100000));
  return [options] { return simulate(*options); };
}

}  // namespace ca2
