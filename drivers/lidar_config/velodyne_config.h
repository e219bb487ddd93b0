/// @file Reading and setting up a Velodyne through its web pages (all models but the HDL-64E have them).
#pragma once

#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/lidar_config/setting.h"
#include "drivers/net/http_client.h"

namespace ca2 {

/// Settings are named as in the snapshot: rpm, returns (Strongest, Last, Dual), laser (on, off), fov.start,
/// fov.end (deg), host.addr, host.dport, host.tport, phaselock.enabled, phaselock.offset. The sensor's own
/// network address is left alone: a wrong one loses the sensor.
class VelodyneConfig {
 public:
  VelodyneConfig(const std::string& host, HttpOptions options = {}) : client_(host, options) {}

  /// /cgi/snapshot.hdl and /cgi/info.json, as the sensor gives them (JSON objects). Errors: `unavailable`,
  /// and `data` for anything else than such an object.
  Result<std::string> read_snapshot() const;
  Result<std::string> read_info() const;

  /// What the sensor has otherwise than wanted: the dry run. Errors: `config` for unknown settings.
  Result<std::vector<SettingChange>> plan(const std::vector<Setting>& wanted) const;

  /// One POST per change; `persist` saves them over power cycles. Errors: `config` if the sensor refuses.
  Result<void> apply(const std::vector<SettingChange>& changes, bool persist) const;

 private:
  Result<std::string> read_object(const std::string& path) const;
  Result<void> post(const std::string& path, const std::string& form) const;

  HttpClient client_;
};

}  // namespace ca2
