/// @file Reading an Ouster's metadata and setting it up over the network: the HTTP API of firmware 3.1 and
/// later, the command paths of 2.x, and the TCP text protocol of 1.x.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/lidar_config/setting.h"
#include "drivers/net/http_client.h"
#include "drivers/net/line_client.h"

namespace ca2 {

struct OusterConfigOptions {
  HttpOptions http;
  LineOptions tcp;
  std::chrono::milliseconds poll{500};  ///< between looks at the status after a change
};

/// How a sensor is talked to. Values in and out are JSON texts.
class OusterApi {
 public:
  OusterApi() = default;
  OusterApi(const OusterApi&) = delete;
  OusterApi& operator=(const OusterApi&) = delete;
  virtual ~OusterApi() = default;

  virtual const char* name() const = 0;
  /// The whole metadata, in the newer (sectioned) layout.
  virtual Result<std::string> metadata() = 0;
  /// The section sensor_info.
  virtual Result<std::string> sensor_info() = 0;
  /// The active configuration, an object.
  virtual Result<std::string> active_config() = 0;
  /// Makes the keys of the object active by a reinitialisation; `persist`: over power cycles too.
  virtual Result<void> apply(const std::string& config, bool persist) = 0;
};

/// An Ouster that answered. Nothing is changed but by apply().
class OusterConfig {
 public:
  /// Finds out which way the sensor's firmware talks. `host`: name or address. Errors: `unavailable` when
  /// neither HTTP nor TCP answers, `data` when what answers is no Ouster.
  static Result<OusterConfig> connect(const std::string& host, const OusterConfigOptions& options = {});

  /// "HTTP config", "HTTP commands" or "TCP".
  std::string api() const { return api_->name(); }

  /// The metadata JSON that decoding needs, as parse_ouster_metadata takes it.
  Result<std::string> read_metadata() const { return api_->metadata(); }

  /// RUNNING, WARMUP, ...
  Result<std::string> status() const;

  /// What the sensor has otherwise than wanted: the dry run. Empty: nothing to do, and nothing should be
  /// done, since every change costs a restart of some seconds. "udp_dest: @auto" means this host; names that
  /// older firmware has otherwise (udp_ip, auto_start_flag) are translated. Errors: `config` for settings
  /// this firmware does not have.
  Result<std::vector<SettingChange>> plan(const std::vector<Setting>& wanted) const;

  /// Sets what plan() found. Errors: `config` with the sensor's words if it refuses.
  Result<void> apply(const std::vector<SettingChange>& changes, bool persist) const;

  /// Waits until the sensor runs again; metadata is complete only then. Errors: `unavailable` after `limit`,
  /// or when the status is ERROR.
  Result<void> wait_until_running(std::chrono::milliseconds limit) const;

 private:
  OusterConfig(std::string host, OusterConfigOptions options, std::unique_ptr<OusterApi> api)
      : host_(std::move(host)), options_(options), api_(std::move(api)) {}

  std::string host_;
  OusterConfigOptions options_;
  std::unique_ptr<OusterApi> api_;
};

/// The three ways. make_ouster_http_api's `commands`: the paths of firmware before 3.1.
std::unique_ptr<OusterApi> make_ouster_http_api(const HttpClient& client, bool commands);
std::unique_ptr<OusterApi> make_ouster_tcp_api(const LineClient& client);

/// The address of this host that `host` sees, or an error `unavailable`.
Result<std::string> own_address_towards(const std::string& host);

}  // namespace ca2
