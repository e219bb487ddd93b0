/// @file The text protocol of Ouster's firmware 1.x.
#include <nlohmann/json.hpp>

#include "core/io/json.h"
#include "drivers/lidar_config/ouster_config.h"
#include "drivers/lidar_config/ouster_sections.h"

namespace ca2 {
namespace {

using nlohmann::json;

class TcpApi : public OusterApi {
 public:
  explicit TcpApi(const LineClient& client) : client_(client) {}
  const char* name() const override { return "TCP"; }

  Result<std::string> metadata() override {
    return assemble_ouster_metadata(
        [this](const std::string& section) { return client_.ask("get_" + section); }, active_config());
  }

  Result<std::string> sensor_info() override { return object_from("get_sensor_info"); }
  Result<std::string> active_config() override { return object_from("get_config_param active"); }

  Result<void> apply(const std::string& config, bool persist) override {
    const json settings = json::parse(config);
    std::vector<std::pair<std::string, std::string>> commands;  // and the word that says it was done
    for (const auto& [key, value] : settings.items()) {
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      commands.push_back({"set_config_param " + key + " " + text, "set_config_param"});
    }
    commands.push_back({"reinitialize", "reinitialize"});
    if (persist) commands.push_back({"write_config_txt", "write_config_txt"});
    for (const auto& [command, answer] : commands) {
      const Result<std::string> reply = client_.ask(command);
      if (!reply) return fail(reply.error());
      if (*reply != answer) {
        return fail(ErrorCode::config, "", "the sensor refuses '" + command + "': " + reply->substr(0, 300));
      }
    }
    return {};
  }

 private:
  Result<std::string> object_from(const std::string& command) {
    Result<std::string> reply = client_.ask(command);
    if (reply && !parse_json(*reply).is_object()) {
      return fail(ErrorCode::data, "",
                  "'" + command + "' is answered by no JSON object: " + reply->substr(0, 300),
                  "is this address an Ouster's?");
    }
    return reply;
  }

  LineClient client_;
};

}  // namespace

std::unique_ptr<OusterApi> make_ouster_tcp_api(const LineClient& client) {
  return std::make_unique<TcpApi>(client);
}

}  // namespace ca2
