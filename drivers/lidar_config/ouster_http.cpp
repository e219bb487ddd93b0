/// @file The two HTTP interfaces of Ouster's firmware 2.x and later.
#include <nlohmann/json.hpp>

#include "core/io/json.h"
#include "drivers/lidar_config/ouster_config.h"
#include "drivers/lidar_config/ouster_sections.h"

namespace ca2 {
namespace {

using nlohmann::json;

/// A JSON object from the sensor, or why there is none.
Result<std::string> object_from(const HttpClient& client, const std::string& path) {
  const Result<HttpReply> reply = client.get(path);
  if (!reply) return fail(reply.error());
  if (!reply->ok()) {
    return fail(ErrorCode::data, client.url(path),
                "the sensor answers HTTP " + std::to_string(reply->status));
  }
  if (!parse_json(reply->body).is_object()) {
    return fail(ErrorCode::data, client.url(path), "the answer is no JSON object",
                "is this address an Ouster's?");
  }
  return reply->body;
}

/// A request that is to succeed; else the sensor's own words, which are short.
Result<std::string> done_by(const HttpClient& client, const std::string& path,
                            const Result<HttpReply>& reply) {
  if (!reply) return fail(reply.error());
  if (reply->ok()) return reply->body;
  return fail(
      ErrorCode::config, client.url(path),
      "the sensor refuses (HTTP " + std::to_string(reply->status) + "): " + reply->body.substr(0, 300));
}

/// Metadata and sensor_info are at the same place in both.
class HttpApi : public OusterApi {
 public:
  explicit HttpApi(const HttpClient& client) : client_(client) {}

  Result<std::string> metadata() override {
    const std::string path = "/api/v1/sensor/metadata";
    Result<std::string> whole = object_from(client_, path);
    if (whole || whole.error().code == ErrorCode::unavailable) return whole;
    // The first firmware with HTTP has only the sections.
    const auto ask = [&](const std::string& section) -> Result<std::string> {
      const Result<HttpReply> reply = client_.get(path + "/" + section);
      if (!reply) return fail(reply.error());
      return reply->ok() ? reply->body : "error: HTTP " + std::to_string(reply->status);
    };
    return assemble_ouster_metadata(ask, active_config());
  }
  Result<std::string> sensor_info() override {
    return object_from(client_, "/api/v1/sensor/metadata/sensor_info");
  }

 protected:
  HttpClient client_;
};

/// Firmware 3.1 and later.
class ConfigApi : public HttpApi {
 public:
  using HttpApi::HttpApi;
  const char* name() const override { return "HTTP config"; }
  Result<std::string> active_config() override { return object_from(client_, "/api/v1/sensor/config"); }

  Result<void> apply(const std::string& config, bool persist) override {
    const std::string stage = "/api/v1/sensor/config?staging=true&reinit=false&persist=false";
    auto staged = done_by(client_, stage, client_.post(stage, config, "application/json"));
    if (!staged) return fail(staged.error());
    const std::string activate =
        std::string("/api/v1/sensor/config?staging=true&reinit=true&persist=") + (persist ? "true" : "false");
    auto active = done_by(client_, activate, client_.post(activate, "{}", "application/json"));
    if (!active) return fail(active.error());
    return {};
  }
};

/// Firmware 2.0 to 3.0.
class CommandApi : public HttpApi {
 public:
  using HttpApi::HttpApi;
  const char* name() const override { return "HTTP commands"; }
  Result<std::string> active_config() override {
    return object_from(client_, "/api/v1/sensor/cmd/get_config_param?args=active");
  }

  Result<void> apply(const std::string& config, bool persist) override {
    const json settings = json::parse(config);
    for (const auto& [key, value] : settings.items()) {
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      const std::string path = "/api/v1/sensor/cmd/set_config_param?args=" + key + "+" + url_encode(text);
      const auto set = done_by(client_, path, client_.get(path));
      if (!set) return fail(set.error());
      if (parse_json(*set) != "set_config_param") {
        return fail(ErrorCode::config, client_.url(path), "the sensor refuses: " + set->substr(0, 300));
      }
    }
    std::vector<std::string> commands{"/api/v1/sensor/cmd/reinitialize"};
    if (persist) commands.push_back("/api/v1/sensor/cmd/save_config_params");
    for (const std::string& path : commands) {
      if (const auto done = done_by(client_, path, client_.get(path)); !done) return fail(done.error());
    }
    return {};
  }
};

}  // namespace

std::unique_ptr<OusterApi> make_ouster_http_api(const HttpClient& client, bool commands) {
  if (commands) return std::make_unique<CommandApi>(client);
  return std::make_unique<ConfigApi>(client);
}

}  // namespace ca2
