#include "tools/ca2/configurable_sensor.h"

#include <nlohmann/json.hpp>

#include "tools/ca2/host_port.h"

namespace ca2 {

Result<std::vector<SettingChange>> ConfigurableSensor::plan(const std::vector<Setting>& wanted) const {
  return ouster ? ouster->plan(wanted) : velodyne->plan(wanted);
}

Result<void> ConfigurableSensor::apply(const std::vector<SettingChange>& changes, bool persist) const {
  return ouster ? ouster->apply(changes, persist) : velodyne->apply(changes, persist);
}

Result<std::string> ConfigurableSensor::read_metadata() const {
  return ouster ? ouster->read_metadata() : velodyne->read_snapshot();
}

Result<std::string> ConfigurableSensor::read_identity() const {
  if (velodyne) return velodyne->read_info();
  const Result<std::string> metadata = ouster->read_metadata();
  if (!metadata) return fail(metadata.error());
  const auto all = nlohmann::json::parse(*metadata);
  return all.value("sensor_info", nlohmann::json::object()).dump();
}

Result<ConfigurableSensor> connect_sensor(const std::string& address, const std::string& vendor) {
  const Result<HostPort> parsed = parse_host_port(address);
  if (!parsed) return fail(parsed.error());
  OusterConfigOptions options;
  if (parsed->port != 0) options.http.port = parsed->port;
  ConfigurableSensor sensor;
  std::vector<Problem> problems;
  ErrorCode code = ErrorCode::unavailable;
  const auto note = [&](const Error& error) {
    code = error.code;
    problems.insert(problems.end(), error.problems.begin(), error.problems.end());
  };
  if (vendor != "velodyne") {
    if (Result<OusterConfig> config = OusterConfig::connect(parsed->host, options)) {
      sensor.ouster.emplace(std::move(*config));
      return sensor;
    } else {
      note(config.error());
    }
  }
  if (vendor != "ouster") {
    const VelodyneConfig config(parsed->host, options.http);
    if (const Result<std::string> snapshot = config.read_snapshot()) {
      sensor.velodyne.emplace(config);
      return sensor;
    } else {
      note(snapshot.error());
    }
  }
  return fail(code, std::move(problems));
}

}  // namespace ca2
