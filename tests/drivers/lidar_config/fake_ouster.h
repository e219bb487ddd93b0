/// @file An Ouster on the loopback, of firmware that talks HTTP.
#pragma once

#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/drivers/lidar_config/fake_servers.h"

namespace ca2::test {

using nlohmann::json;

inline json beams(int count) {
  json angles = json::array();
  for (int i = 0; i < count; ++i) angles.push_back(20.0 - i);
  return angles;
}

/// What a sensor is, and what it was told; shared by the three firmwares' servers.
struct FakeOuster {
  json config = {{"udp_dest", "192.0.2.50"}, {"udp_port_lidar", 7502},     {"udp_port_imu", 7503},
                 {"lidar_mode", "1024x10"},  {"operating_mode", "NORMAL"}, {"azimuth_window", {0, 360000}}};
  json staged = json::object();
  std::vector<std::string> log;  ///< everything that changes something
  int warming_up = 0;            ///< looks at the status until it runs
  std::mutex mutex;

  json section(const std::string& name) {
    if (name == "sensor_info") {
      const char* status = warming_up > 0 ? "WARMUP" : "RUNNING";
      warming_up = std::max(0, warming_up - 1);
      return {
          {"status", status}, {"prod_line", "OS-1-32"}, {"prod_sn", "992011000121"}, {"build_rev", "v3.1.0"}};
    }
    if (name == "beam_intrinsics") {
      return {{"beam_altitude_angles", beams(32)}, {"beam_azimuth_angles", beams(32)}};
    }
    if (name == "lidar_data_format") {
      return {{"pixels_per_column", 32},       {"columns_per_packet", 16},
              {"columns_per_frame", 1024},     {"column_window", {0, 1023}},
              {"udp_profile_lidar", "LEGACY"}, {"pixel_shift_by_row", std::vector<int>(32, 0)}};
    }
    return json::object();
  }
  json metadata() {
    json all = {{"config_params", config}};
    for (const char* name : {"sensor_info", "beam_intrinsics", "imu_intrinsics", "lidar_intrinsics",
                             "lidar_data_format", "calibration_status"}) {
      all[name] = section(name);
    }
    return all;
  }
  void reinitialize() {
    config.update(staged);
    staged.clear();
    warming_up = 2;
  }
};

using Handler = std::function<void(const httplib::Request&, httplib::Response&)>;

/// Firmware 3.1 (`commands` false) or 2.x.
class FakeOusterHttp : public FakeHttp {
 public:
  FakeOusterHttp(FakeOuster& sensor, bool commands) : sensor_(sensor) {
    if (!commands)
      get("/api/v1/sensor/metadata", [this](auto&, auto& out) { reply(out, sensor_.metadata()); });
    for (const char* name : {"beam_intrinsics", "imu_intrinsics", "lidar_intrinsics", "lidar_data_format"}) {
      get((std::string("/api/v1/sensor/metadata/") + name).c_str(),
          [this, name](auto&, auto& out) { reply(out, sensor_.section(name)); });
    }
    get("/api/v1/sensor/metadata/sensor_info",
        [this](auto&, auto& out) { reply(out, sensor_.section("sensor_info")); });
    commands ? add_commands() : add_config();
    start();
  }

 private:
  Handler locked(Handler handler) {
    return [this, handler](const httplib::Request& in, httplib::Response& out) {
      const std::lock_guard lock(sensor_.mutex);
      handler(in, out);
    };
  }
  void get(const char* path, Handler handler) { server.Get(path, locked(handler)); }
  static void reply(httplib::Response& out, const json& value) {
    out.set_content(value.dump(), "application/json");
  }

  void add_config() {
    get("/api/v1/sensor/config", [this](auto&, auto& out) { reply(out, sensor_.config); });
    server.Post("/api/v1/sensor/config", locked([this](auto& in, auto& out) {
                  const json body = json::parse(in.body, nullptr, false);
                  if (!body.is_object() || body.value("lidar_mode", "1024x10") == "3x3") {
                    out.status = 400;
                    out.set_content("invalid value for lidar_mode", "text/plain");
                    return;
                  }
                  sensor_.staged.update(body);
                  sensor_.log.push_back("POST " + body.dump() + " reinit=" + in.get_param_value("reinit") +
                                        " persist=" + in.get_param_value("persist"));
                  if (in.get_param_value("reinit") == "true") sensor_.reinitialize();
                  reply(out, json::object());
                }));
  }

  void add_commands() {
    const std::string base = "/api/v1/sensor/cmd/";
    get((base + "get_config_param").c_str(), [this](auto& in, auto& out) {
      reply(out, in.get_param_value("args") == "active" ? sensor_.config : sensor_.staged);
    });
    get((base + "set_config_param").c_str(), [this](auto& in, auto& out) {
      const std::string args = in.get_param_value("args");
      const std::string key = args.substr(0, args.find(' ')), value = args.substr(args.find(' ') + 1);
      sensor_.log.push_back("set " + key + " = " + value);
      if (value == "3x3") {
        out.set_content("\"error: invalid lidar mode\"", "text/plain");
        return;
      }
      json parsed = json::parse(value, nullptr, false);
      sensor_.staged[key] = parsed.is_discarded() ? json(value) : parsed;
      reply(out, "set_config_param");
    });
    for (const char* command : {"reinitialize", "save_config_params"}) {
      get((base + command).c_str(), [this, command](auto&, auto& out) {
        sensor_.log.push_back(command);
        if (std::string(command) == "reinitialize") sensor_.reinitialize();
        reply(out, json::object());
      });
    }
  }

  FakeOuster& sensor_;
};

}  // namespace ca2::test
