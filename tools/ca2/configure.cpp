/// @file `ca2 configure HOST`: what a LiDAR is set to, what would change, and, when told to, the change.
#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "tools/ca2/command.h"
#include "tools/ca2/configurable_sensor.h"
#include "tools/ca2/host_port.h"
#include "tools/ca2/number_in.h"

namespace ca2 {
namespace {

/// An option that both vendors, or one, have under a name of their own.
struct CommonSetting {
  const char* option;
  const char* ouster;    ///< nullptr: has no such setting
  const char* velodyne;  ///< nullptr: has no such setting
  const char* help;
};
constexpr CommonSetting common_settings[] = {
    {"--destination", "udp_dest", "host.addr", "Where its packets go; @auto: to this host"},
    {"--lidar-port", "udp_port_lidar", "host.dport", "UDP port of LiDAR packets"},
    {"--imu-port", "udp_port_imu", "host.tport", "UDP port of IMU (Velodyne: position) packets"},
    {"--mode", "lidar_mode", nullptr, "Ouster: columns and revolutions per second, e.g. 1024x10"},
    {"--profile", "udp_profile_lidar", nullptr, "Ouster: packet format, e.g. RNG19_RFL8_SIG16_NIR16"},
    {"--rpm", nullptr, "rpm", "Velodyne: revolutions per minute, 300 to 1200 in steps of 60"},
    {"--returns", nullptr, "returns", "Velodyne: Strongest, Last or Dual"},
};

struct Options {
  std::string host, vendor = "auto";
  std::array<std::string, std::size(common_settings)> common;
  std::vector<std::string> set;  // KEY=VALUE
  std::filesystem::path metadata;
  double wait = 90;  // s
  bool apply = false, persist = false, as_json = false;
};

Result<std::vector<Setting>> wanted_settings(const Options& options, const ConfigurableSensor& sensor) {
  std::vector<Setting> wanted;
  for (std::size_t i = 0; i < options.common.size(); ++i) {
    if (options.common[i].empty()) continue;
    const CommonSetting& setting = common_settings[i];
    const char* key = sensor.ouster ? setting.ouster : setting.velodyne;
    if (!key) {
      return fail(
          ErrorCode::usage, "",
          std::string(setting.option) + " is no setting of " + (sensor.ouster ? "an Ouster" : "a Velodyne"));
    }
    wanted.push_back({key, options.common[i]});
  }
  for (const std::string& text : options.set) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos) {
      return fail(ErrorCode::usage, "", "'" + text + "' is not KEY=VALUE");
    }
    wanted.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  for (Setting& setting : wanted) {
    // An Ouster knows @auto itself where its firmware does, and its plan() looks it up where not.
    if (sensor.ouster || setting.value != "@auto") continue;
    const Result<HostPort> address = parse_host_port(options.host);
    const Result<std::string> own = own_address_towards(address->host);
    if (!own) return fail(own.error());
    setting.value = *own;
  }
  return wanted;
}

/// Applies, waits until the sensor has restarted, and looks whether it did what it was told.
Result<void> apply(const Options& options, const ConfigurableSensor& sensor,
                   const std::vector<Setting>& wanted, const std::vector<SettingChange>& changes) {
  if (auto done = sensor.apply(changes, options.persist); !done) return done;
  if (sensor.ouster) {
    const std::chrono::milliseconds limit(static_cast<std::int64_t>(1000 * options.wait));
    if (auto runs = sensor.ouster->wait_until_running(limit); !runs) return runs;
  }
  const Result<std::vector<SettingChange>> left = sensor.plan(wanted);
  if (!left) return fail(left.error());
  if (left->empty()) return {};
  std::vector<Problem> problems;
  for (const SettingChange& change : *left) {
    problems.push_back({options.host, change.key + " is still " + change.from + ", not " + change.to, ""});
  }
  return fail(ErrorCode::config, std::move(problems));
}

Result<void> save_metadata(const Options& options, const ConfigurableSensor& sensor) {
  if (options.metadata.empty()) return {};
  const Result<std::string> text = sensor.read_metadata();
  if (!text) return fail(text.error());
  return write_atomically(options.metadata, *text);
}

void print(const Options& options, const ConfigurableSensor& sensor,
           const std::vector<SettingChange>& changes) {
  if (options.as_json) {
    auto list = nlohmann::ordered_json::array();
    for (const SettingChange& change : changes) {
      list.push_back({{"key", change.key}, {"from", change.from}, {"to", change.to}});
    }
    const nlohmann::ordered_json report = {{"host", options.host},
                                           {"vendor", sensor.vendor()},
                                           {"changes", list},
                                           {"applied", options.apply && !changes.empty()}};
    std::printf("%s\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    return;
  }
  for (const SettingChange& change : changes) {
    std::printf("%s: %s -> %s\n", change.key.c_str(), change.from.c_str(), change.to.c_str());
  }
  if (changes.empty()) {
    std::puts("nothing to change");
  } else {
    std::puts(options.apply ? "done" : "nothing was changed: --apply does it");
  }
}

Result<int> run(const Options& options) {
  const Result<ConfigurableSensor> sensor = connect_sensor(options.host, options.vendor);
  if (!sensor) return fail(sensor.error());
  const Result<std::vector<Setting>> wanted = wanted_settings(options, *sensor);
  if (!wanted) return fail(wanted.error());
  const Result<std::vector<SettingChange>> changes = sensor->plan(*wanted);
  if (!changes) return fail(changes.error());
  // Not even a change to what is there already: every one costs a restart.
  if (options.apply && !changes->empty()) {
    if (auto done = apply(options, *sensor, *wanted, *changes); !done) return fail(done.error());
  }
  if (auto saved = save_metadata(options, *sensor); !saved) return fail(saved.error());
  print(options, *sensor, *changes);
  return 0;
}

}  // namespace

CommandBody setup_configure(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("host", options->host, "The sensor: HOST, or HOST:PORT of its web server")->required();
  app.add_option("--vendor", options->vendor, "auto: whichever answers")
      ->check(CLI::IsMember({"auto", "ouster", "velodyne"}))
      ->capture_default_str();
  for (std::size_t i = 0; i < std::size(common_settings); ++i) {
    app.add_option(common_settings[i].option, options->common[i], common_settings[i].help);
  }
  app.add_option("--set", options->set, "KEY=VALUE, by the vendor's own name; may be repeated");
  app.add_option("--save-metadata", options->metadata,
                 "Write what decoding needs to know (Ouster) or the snapshot (Velodyne) to this file");
  app.add_flag("--apply", options->apply, "Change the sensor; without it, say what would change");
  app.add_flag("--persist", options->persist, "With --apply: over power cycles too")->needs("--apply");
  app.add_option("--wait", options->wait, "Seconds an Ouster may take to restart")
      ->check(seconds())
      ->capture_default_str();
  app.add_flag("--json", options->as_json, "For programs");
  return [options] { return run(*options); };
}

}  // namespace ca2
