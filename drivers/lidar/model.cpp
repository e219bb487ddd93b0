#include "drivers/lidar/model.h"

#include <cctype>
#include <cmath>

#include "drivers/lidar/ouster/metadata_defaults.h"

namespace ca2 {

#define CA2_LIDAR_MODEL(name) LidarModel lidar_model_##name();
#include "drivers/lidar/models.def"
#undef CA2_LIDAR_MODEL

namespace {

/// "VLP-16", "vlp16" and "vlp_16" are one name.
std::string folded(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return out;
}

}  // namespace

const std::vector<LidarModel>& lidar_models() {
  static const std::vector<LidarModel> models{
#define CA2_LIDAR_MODEL(name) lidar_model_##name(),
#include "drivers/lidar/models.def"
#undef CA2_LIDAR_MODEL
  };
  return models;
}

Result<const LidarModel*> find_lidar_model(std::string_view name) {
  std::string known;
  for (const LidarModel& model : lidar_models()) {
    if (folded(model.name) == folded(name)) return &model;
    known += (known.empty() ? "" : ", ") + model.name;
  }
  return fail(ErrorCode::config, "", "unknown LiDAR model '" + std::string(name) + "'",
              "known models: " + known);
}

Result<VelodyneCalibration> velodyne_calibration(const VelodyneModel& model, const std::string& name,
                                                 const std::filesystem::path& file) {
  if (!file.empty()) return read_velodyne_calibration(file, model.lasers);
  if (model.factory.lasers.empty()) {
    return fail(ErrorCode::config, "", "the angles of a " + name + " are per unit and none were given",
                "give the calibration that came with the sensor (db.xml, or the YAML made from it)");
  }
  return model.factory;
}

OusterMetadata nominal_ouster_metadata(const OusterModel& model, int columns, double rate,
                                       std::string_view profile) {
  OusterMetadata out;
  out.prod_line = model.prod_line;
  out.lidar_mode = std::to_string(columns) + "x" + std::to_string(std::lround(rate));
  out.profile = profile;
  out.fusa_header = profile.starts_with("FUSA_");
  out.pixels_per_column = model.beams;
  out.columns_per_frame = columns;
  out.rate = rate;
  out.window_last = columns - 1;
  for (int row = 0; row < model.beams; ++row) {
    out.altitude.push_back(model.top_degrees * (1 - 2.0 * row / (model.beams - 1)));
    out.azimuth.push_back(model.azimuth_step_degrees * (3 - 2 * (row % 4)));
  }
  out.pixel_shift = default_pixel_shift(out.azimuth, columns);
  out.beam_origin_x = model.beam_origin_mm;
  out.lidar_to_sensor = default_lidar_to_sensor();
  out.imu_to_sensor = default_imu_to_sensor();
  return out;
}

}  // namespace ca2
