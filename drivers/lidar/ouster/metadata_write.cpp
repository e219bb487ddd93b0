#include <nlohmann/json.hpp>

#include "drivers/lidar/ouster/metadata.h"

namespace ca2 {
namespace {

std::vector<double> row_major(const Eigen::Matrix4d& matrix) {
  std::vector<double> out;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) out.push_back(matrix(row, column));
  }
  return out;
}

}  // namespace

std::string write_ouster_metadata(const OusterMetadata& m) {
  Eigen::Matrix4d beam_to_lidar = Eigen::Matrix4d::Identity();
  beam_to_lidar(0, 3) = m.beam_origin_x;
  beam_to_lidar(2, 3) = m.beam_origin_z;
  nlohmann::ordered_json json;
  json["sensor_info"] = {{"prod_line", m.prod_line},
                         {"prod_sn", std::to_string(m.serial)},
                         {"build_rev", m.firmware},
                         {"initialization_id", m.init_id},
                         {"status", "RUNNING"}};
  json["beam_intrinsics"] = {{"beam_altitude_angles", m.altitude},
                             {"beam_azimuth_angles", m.azimuth},
                             {"lidar_origin_to_beam_origin_mm", m.beam_origin_x},
                             {"beam_to_lidar_transform", row_major(beam_to_lidar)}};
  json["imu_intrinsics"] = {{"imu_to_sensor_transform", row_major(m.imu_to_sensor)}};
  json["lidar_intrinsics"] = {{"lidar_to_sensor_transform", row_major(m.lidar_to_sensor)}};
  json["lidar_data_format"] = {{"pixels_per_column", m.pixels_per_column},
                               {"columns_per_packet", m.columns_per_packet},
                               {"columns_per_frame", m.columns_per_frame},
                               {"column_window", {m.window_first, m.window_last}},
                               {"pixel_shift_by_row", m.pixel_shift},
                               {"udp_profile_lidar", m.profile},
                               {"udp_profile_imu", m.imu_profile},
                               {"fps", m.rate},
                               {"header_type", m.fusa_header ? "FUSA" : "STANDARD"}};
  if (m.imu_per_packet > 0) json["imu_data_format"] = {{"imu_measurements_per_packet", m.imu_per_packet}};
  json["config_params"] = {{"lidar_mode", m.lidar_mode},
                           {"timestamp_mode", m.timestamp_mode},
                           {"udp_port_lidar", m.lidar_port},
                           {"udp_port_imu", m.imu_port}};
  json["calibration_status"] = nlohmann::json::object();
  return json.dump(2) + "\n";
}

}  // namespace ca2
