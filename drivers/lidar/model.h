/// @file The LiDAR models Ca2 knows: constants of the wire format, timing and factory angles.
/// One file per family in models/, one line per model in models.def (docs/adding-a-lidar.md).
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/types/result.h"
#include "drivers/lidar/beam_table.h"
#include "drivers/lidar/ouster/metadata.h"
#include "drivers/lidar/velodyne/velodyne_model.h"

namespace ca2 {

/// An Ouster product. The angles of a real unit come with its metadata; these are even ones for simulation.
struct OusterModel {
  std::string prod_line;                ///< as metadata spells it: "OS-0-128"
  int beams = 0;                        ///< pixels per column
  double top_degrees = 0;               ///< elevation of row 0; the last row is at minus this
  double azimuth_step_degrees = 0;      ///< four columns of lasers look at 3, 1, -1 and -3 times this
  double beam_origin_mm = 0;            ///< distance of the beams' origin from the axis of rotation
  double min_range = 0, max_range = 0;  ///< m
};

struct LidarModel {
  std::string name;  ///< what a user writes: "VLP-16", "OS0-128"
  std::variant<OusterModel, VelodyneModel> family;

  const OusterModel* ouster() const { return std::get_if<OusterModel>(&family); }
  const VelodyneModel* velodyne() const { return std::get_if<VelodyneModel>(&family); }
};

/// Every model, in the order of models.def.
const std::vector<LidarModel>& lidar_models();

/// Finds by name, letter case, '-', '_' and ' ' ignored; an unknown one is ErrorCode::config with the list.
Result<const LidarModel*> find_lidar_model(std::string_view name);

/// The calibration that `file` holds, or the factory's table when it is empty; a model whose angles are per
/// unit is refused without a file (ErrorCode::config).
Result<VelodyneCalibration> velodyne_calibration(const VelodyneModel& model, const std::string& name,
                                                 const std::filesystem::path& file);

/// Metadata of a simulated unit of this model: even angles, the vendor's default transforms.
OusterMetadata nominal_ouster_metadata(const OusterModel& model, int columns, double rate,
                                       std::string_view profile);

}  // namespace ca2
