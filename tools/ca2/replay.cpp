/// @file `ca2 replay`: a recording through the capture pipeline, then the solve.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "core/types/counted.h"
#include "drivers/recording/replay.h"
#include "tools/ca2/command.h"
#include "tools/ca2/hold_tally.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/print_warnings.h"
#include "tools/ca2/progress.h"
#include "tools/ca2/solve_session.h"

namespace ca2 {
namespace {

struct Options {
  std::string recording, session;
  ReplayOptions replay;
  bool json = false, verbose = false;
};

/// Simulated recordings know the truth: their session shall, too.
void carry_truth(const Recording& recording, const std::filesystem::path& session) {
  std::error_code ignored;
  std::filesystem::copy_file(recording.directory / "truth.yaml", session / "truth.yaml", ignored);
}

Result<int> run(Options options) {
  const Result<Recording> recording = open_recording(options.recording);
  if (!recording) return fail(recording.error());
  Result<RecordingReader> reader = RecordingReader::open(*recording);
  if (!reader) return fail(reader.error());
  Result<Session> session = session_of(*recording, options.session);
  if (!session) return fail(session.error());
  carry_truth(*recording, session->directory);

  Progress progress("replaying");
  if (options.verbose) {
    options.replay.event = [&](const CaptureEvent& event) {
      std::fprintf(stderr, "%8.3f %-9s %s\n", 1e-9 * static_cast<double>(event.time - recording->start),
                   event.kind.c_str(), event.text.c_str());
    };
  } else {
    options.replay.progress = [&](const CapturePipeline&, std::int64_t) {
      progress.show(reader->pictures_read(), reader->pictures());
    };
  }
  const Result<ReplayReport> report = replay(recording->rig, *reader, *session, options.replay);
  print_warnings(reader->warnings());
  if (!report) return fail(report.error());
  if (!options.json) std::printf("%s captured\n", counted(report->stored.size(), "view").c_str());
  const auto tally = tally_holds(recording->directory / "truth.yaml", *session, report->stored);
  if (!tally) return fail(tally.error());
  if (*tally && !options.json) std::printf("%s\n", (*tally)->text().c_str());
  if (session->views.empty()) {
    return fail(ErrorCode::refused, options.recording, "the board was never held still in view of a pair",
                "`--verbose` says what was seen and why it was not captured");
  }
  SolveArguments solve;
  solve.session = options.session;
  solve.json = options.json;
  return solve_session(solve);
}

}  // namespace

CommandBody setup_replay(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("recording", options->recording, "Recording directory (docs/recording.md)")
      ->required()
      ->type_name("RECORDING");
  app.add_option("--session", options->session, "Session to create, or to add the views to")
      ->required()
      ->type_name("DIR");
  app.add_option("--speed", options->replay.speed, "1: as it was recorded; 0: as fast as possible")
      ->check(number_in(0, 1000))
      ->capture_default_str();
  app.add_option("--dwell", options->replay.capture.dwell, "How long the board must be still, s")
      ->check(number_in(0.1, 10))
      ->capture_default_str();
  app.add_option("--threads", options->replay.threads, "Threads for the search (default: one per core)")
      ->check(number_in(1, 256));
  app.add_flag("--json", options->json, "Print the result as JSON");
  app.add_flag("--verbose", options->verbose, "Say on stderr what is captured, when, and why not");
  app.footer(
      "The same pipeline as the daemon's: the board is found in every picture and scan, captured where it is "
      "held\n"
      "still, and the session calibrated as `ca2 solve` does it. The same recording gives the same files, "
      "bit "
      "for bit.");
  return [options] { return run(*options); };
}

}  // namespace ca2
