#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "tools/ca2/command.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/progress.h"
#include "tools/sim/recording_writer.h"
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
  Result<ScenarioFile> scenario = read_scenario(options.scenario);
  if (!scenario) return fail(scenario.error());
  if (options.seed) scenario->scenario.seed = *options.seed;
  if (options.views) scenario->scenario.views = *options.views;
  Progress line(options.recording ? "rendering pictures" : "simulating views");
  const auto progress = [&](int done, int all) { line.show(done, all); };
  const Result<void> written = options.recording
                                   ? write_simulated_recording(*scenario, options.output, progress)
                                   : write_simulated_session(*scenario, options.output, progress);
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
  app.add_flag("--recording", options->recording,
               "Write a recording: raw packets and pictures of the board being carried")
      ->excludes(session);
  app.add_option("--seed", options->seed, "Instead of the scenario's seed")->type_name("N");
  app.add_option("--views", options->views, "Instead of the scenario's number of views (recording: holds)")
      ->type_name("N")
      ->check(number_in(1, 100000));
  return [options] { return simulate(*options); };
}

}  // namespace ca2
