#include "drivers/lidar_config/ouster_sections.h"

#include <nlohmann/json.hpp>

#include "core/io/json.h"

namespace ca2 {

using nlohmann::json;

Result<std::string> assemble_ouster_metadata(
    const std::function<Result<std::string>(const std::string& section)>& ask,
    const Result<std::string>& config) {
  if (!config) return fail(config.error());
  json all = {{"config_params", json::parse(*config)}};
  for (const char* section : {"sensor_info", "beam_intrinsics", "imu_intrinsics", "lidar_intrinsics",
                              "lidar_data_format", "calibration_status"}) {
    const Result<std::string> reply = ask(section);
    if (!reply) return fail(reply.error());
    json value = parse_json(*reply);
    all[section] = value.is_object() ? std::move(value) : json(*reply);
  }
  return all.dump(2, ' ', false, json::error_handler_t::replace);
}

}  // namespace ca2
