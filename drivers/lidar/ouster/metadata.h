/// @file What an Ouster says about itself: the JSON that decoding its packets needs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// Both layouts of metadata (flat: firmware 1.x and TCP; sections: HTTP API) with the vendor's defaults for
/// what is missing. Transforms map points and are in the vendor's millimetres.
struct OusterMetadata {
  std::string prod_line;   ///< "OS-0-128", ...; empty: not given
  std::string firmware;    ///< build_rev, "v2.3.0"; empty: not given
  std::string lidar_mode;  ///< "1024x10"
  std::string timestamp_mode;
  std::uint64_t serial = 0;   ///< 0: not given, packets are not checked against it
  std::uint32_t init_id = 0;  ///< changes when the sensor (re)initialises; 0: not given

  std::string profile = "LEGACY";      ///< of lidar packets, a name of ouster_profiles() or "OFF"
  std::string imu_profile = "LEGACY";  ///< of IMU packets
  bool fusa_header = false;            ///< packet header of the functional safety kind
  int pixels_per_column = 64;
  int columns_per_packet = 16;
  int columns_per_frame = 1024;
  double rate = 10;      ///< rev/s
  int window_first = 0;  ///< measurement ids that carry data, inclusive; first > last wraps
  int window_last = 1023;
  std::vector<int> pixel_shift;  ///< by row: columns by which a row is staggered
  int imu_per_packet = 0;        ///< measurements in an IMU packet of the newer profile; 0: not given

  std::vector<double> altitude;  ///< deg, by row
  std::vector<double> azimuth;   ///< deg, by row
  double beam_origin_x = 0;      ///< mm, lidar frame: from the axis of rotation to the beams' origin
  double beam_origin_z = 0;      ///< mm
  Eigen::Matrix4d lidar_to_sensor = Eigen::Matrix4d::Identity();  ///< translation in mm
  Eigen::Matrix4d imu_to_sensor = Eigen::Matrix4d::Identity();    ///< translation in mm

  int lidar_port = 0;  ///< UDP; 0: not given
  int imu_port = 0;
  std::vector<std::string> warnings;  ///< what was defaulted or does not fit together

  /// Measurement ids that carry data.
  int valid_columns() const;
  /// True for a measurement id inside the column window.
  bool in_window(int measurement_id) const;
};

/// Does the text seem to be metadata, sound or not?
bool is_ouster_metadata(const std::string& text);

/// Problems name the key. Malformed JSON, some but not all sections of the new layout, missing or miscounted
/// beam angles and unknown packet profiles are refused with every problem found (ErrorCode::data).
Result<OusterMetadata> parse_ouster_metadata(const std::string& text, const std::string& where);
Result<OusterMetadata> read_ouster_metadata(const std::filesystem::path& file);

/// The newer (sectioned) layout, which parse_ouster_metadata reads back exactly.
std::string write_ouster_metadata(const OusterMetadata& metadata);

}  // namespace ca2
