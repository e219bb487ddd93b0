/// @file ca2d.yaml: the rig, and how the daemon runs.
#pragma once

#include <filesystem>
#include <string>

#include "core/capture/options.h"
#include "core/session/rig.h"
#include "core/types/result.h"

namespace ca2 {

/// Everything beside the rig; one line of options.def per member, with its meaning.
struct DaemonOptions {
  std::string state_directory = "/var/lib/ca2";
  std::string control_socket = "/run/ca2/control.sock";
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  bool lcm_enabled = true;
  std::string command_keys = "/etc/ca2/keys";
  double preview_rate = 1;        // per second and sensor
  long long preview_width = 480;  // px
  CaptureOptions capture;
};

struct Config {
  std::filesystem::path file;  ///< what relative paths are relative to
  Rig rig;
  DaemonOptions options;
};

/// Every problem of the file is reported: rig, options, and what the sensors' sources ask for.
/// ErrorCode::config; `io` where there is no file.
Result<Config> read_config(const std::filesystem::path& file);
Result<Config> parse_config(const std::string& text, const std::filesystem::path& file);

/// The configuration in force as a ca2d.yaml, every option with its meaning.
std::string write_config(const Config& config);

/// Options that only a restart can change and that differ, by their names ("state.directory").
std::vector<std::string> needs_restart(const DaemonOptions& before, const DaemonOptions& after);

}  // namespace ca2
