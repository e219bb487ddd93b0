/// @file ca2d: sees the board in every sensor, captures when it is still, says what to do next.
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <thread>

#include "ca2_version.h"
#include "daemon/config/config.h"
#include "daemon/daemon.h"
#include "daemon/log.h"
#include "daemon/signals.h"

namespace ca2 {
namespace {

struct Arguments {
  std::string config = "/etc/ca2/ca2d.yaml";
  std::string recording, state, socket, log_level = "info";
  bool check = false, print = false;
};

/// A camera that is being closed, or a solve, may take long; everything that matters is on the disk.
class ExitDeadline {
 public:
  ExitDeadline()
      : thread_([this] {
          std::unique_lock lock(mutex_);
          if (wake_.wait_for(lock, std::chrono::milliseconds(800), [this] { return done_; })) return;
          log::warning("daemon", "a thread does not end in time; it is left behind");
          std::_Exit(EXIT_SUCCESS);
        }) {}
  ~ExitDeadline() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::thread thread_;
};

int report(const Error& error) {
  for (const Problem& problem : error.problems) {
    const Error one(error.code, problem.where, problem.what, problem.hint);
    std::fprintf(stderr, "ca2d: %s\n", one.text().c_str());
  }
  return static_cast<int>(error.code);
}

/// The rig of a recording runs with the options of the configuration file, where there is one.
Result<Config> config_of(const Arguments& arguments, const std::optional<Recording>& recording,
                         bool config_given) {
  Config config;
  if (!recording || config_given) {
    Result<Config> read = read_config(arguments.config);
    if (!read) return read;
    config = std::move(*read);
  }
  if (recording) {
    config.rig = recording->rig;
    config.file = recording->directory / "recording.yaml";
  }
  if (!arguments.state.empty()) config.options.state_directory = arguments.state;
  if (!arguments.socket.empty()) config.options.control_socket = arguments.socket;
  return config;
}

int run(const Arguments& arguments, bool config_given) {
  std::optional<Recording> recording;
  if (!arguments.recording.empty()) {
    Result<Recording> opened = open_recording(arguments.recording);
    if (!opened) return report(opened.error());
    recording = std::move(*opened);
  }
  Result<Config> config = config_of(arguments, recording, config_given);
  if (!config) return report(config.error());
  if (arguments.print) std::printf("%s", write_config(*config).c_str());
  if (arguments.check) std::printf("%s: good\n", config->file.string().c_str());
  if (arguments.print || arguments.check) return 0;

  const auto read_again = [arguments, recording, config_given]() -> Result<Config> {
    if (recording && !config_given) {
      return fail(ErrorCode::usage, recording->directory.string(),
                  "it is played without a configuration: there is nothing to read again",
                  "start with --config FILE for options that can be reloaded");
    }
    return config_of(arguments, recording, config_given);
  };

  block_signals();
  std::optional<ExitDeadline> deadline;
  {
    Daemon daemon(std::move(*config), recording, read_again);
    if (const Result<void> opened = daemon.open(); !opened) {
      deadline.emplace();
      return report(opened.error());
    }
    daemon.run();
    deadline.emplace();
  }
  return 0;
}

}  // namespace
}  // namespace ca2

int main(int argc, char** argv) {
  // Pictures are made by one thread and given back by another: with an arena per thread each of them would
  // keep the room that was ever needed.
  mallopt(M_ARENA_MAX, 2);
  // What is as large as a picture comes from the system and goes back at once. (By default the limit grows
  // with what is given back, and a view's gathered returns leave holes that nothing fits into.)
  mallopt(M_MMAP_THRESHOLD, 512 << 10);
  mallopt(M_TRIM_THRESHOLD, 2 << 20);
  ca2::Arguments arguments;
  CLI::App app("The capture daemon: sees the board in every sensor, captures when it is still.", "ca2d");
  app.set_version_flag("--version", "ca2d " CA2_VERSION);
  CLI::Option* config = app.add_option("--config", arguments.config, "Configuration")->capture_default_str();
  app.add_flag("--check", arguments.check, "Judge the configuration, open nothing; status 78 when it is bad");
  app.add_flag("--print-config", arguments.print, "Print the configuration in force, every option explained");
  app.add_option("--recording", arguments.recording, "A recording in place of the sensors, in time");
  app.add_option("--state", arguments.state, "In place of state.directory");
  app.add_option("--socket", arguments.socket, "In place of control.socket");
  app.add_option("--log-level", arguments.log_level, "debug, info, warning or error")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}))
      ->capture_default_str();
  app.footer("`ca2 status`, `ca2 watch` and others talk to it. SIGHUP reads the configuration again.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "ca2d: %s; see `ca2d --help`\n", error.what());
    return static_cast<int>(ca2::ErrorCode::usage);
  }
  ca2::log::set_level(arguments.log_level);
  return ca2::run(arguments, config->count() > 0);
}
