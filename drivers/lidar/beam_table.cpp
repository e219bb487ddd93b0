#include "drivers/lidar/beam_table.h"

#include <cmath>
#include <numbers>

#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/geometry.h"
#include "drivers/lidar/ouster/profile.h"

namespace ca2 {
namespace {

BeamTable ouster_table(const OusterMetadata& metadata, const OusterModel& model, std::string name) {
  const OusterGeometry geometry = make_ouster_geometry(metadata);
  BeamTable table;
  table.model = std::move(name);
  table.rings = metadata.pixels_per_column;
  table.columns = metadata.columns_per_frame;
  table.rate = metadata.rate;
  const OusterProfile* profile = find_ouster_profile(metadata.profile);
  table.range_quantum = profile ? profile->range_step() * 1e-3 : 1e-3;
  table.min_range = model.min_range;
  table.max_range = model.max_range;
  const double period = 1 / (table.rate * table.columns);
  for (int row = 0; row < table.rings; ++row) {
    for (int column = 0; column < table.columns; ++column) {
      const Eigen::Vector3d origin = geometry.point(row, column, 0);
      table.rays.push_back({origin, (geometry.point(row, column, 1) - origin).normalized()});
      table.time.push_back(column * period);
    }
  }
  return table;
}

BeamTable velodyne_table(const VelodyneModel& model, const VelodyneCalibration& calibration, double rate,
                         std::string name) {
  BeamTable table;
  table.model = std::move(name);
  table.rings = model.lasers;
  table.columns = static_cast<int>(std::floor(1 / (rate * model.cycle)));
  table.rate = rate;
  table.range_quantum = model.distance_lsb;
  table.min_range = model.min_range;
  table.max_range = model.max_range;
  const std::size_t size = static_cast<std::size_t>(table.rings) * table.columns;
  table.rays.resize(size);
  table.time.resize(size);
  const std::vector<int> rings = velodyne_rings(calibration);
  for (int id = 0; id < model.lasers; ++id) {
    const VelodyneLaser& laser = calibration.lasers[static_cast<std::size_t>(id)];
    for (int column = 0; column < table.columns; ++column) {
      const double time = column * model.cycle + model.firing[static_cast<std::size_t>(id)];
      const double azimuth = 2 * std::numbers::pi * rate * time - laser.rotation;
      const double s = std::sin(azimuth), c = std::cos(azimuth);
      const double h = laser.horizontal_offset, cosine = std::cos(laser.vertical);
      const std::size_t at =
          static_cast<std::size_t>(rings[static_cast<std::size_t>(id)]) * table.columns + column;
      table.rays[at] = {{-h * c, h * s, laser.vertical_offset},
                        {cosine * s, cosine * c, std::sin(laser.vertical)}};
      table.time[at] = time;
    }
  }
  return table;
}

/// "OS-1-64-AH" is an OS1-64: what the datasheet says of its range. First generation units are OS1s.
const OusterModel& ouster_product(const std::string& prod_line) {
  const OusterModel* fallback = nullptr;
  for (const LidarModel& model : lidar_models()) {
    const OusterModel* ouster = model.ouster();
    if (!ouster) continue;
    if (prod_line.starts_with(ouster->prod_line.substr(0, 5))) return *ouster;
    if (ouster->prod_line.starts_with("OS-1-")) fallback = ouster;
  }
  return *fallback;
}

}  // namespace

Result<BeamTable> make_beam_table(const LidarModelSpec& spec) {
  if (!spec.metadata.empty()) {
    const Result<OusterMetadata> metadata = read_ouster_metadata(spec.metadata);
    if (!metadata) return fail(metadata.error());
    const std::string name = metadata->prod_line.empty() ? "Ouster" : metadata->prod_line;
    return ouster_table(*metadata, ouster_product(metadata->prod_line), name);
  }
  const Result<const LidarModel*> model = find_lidar_model(spec.model);
  if (!model) return fail(model.error());
  const double rate = spec.rate > 0 ? spec.rate : 10;
  if (const OusterModel* ouster = (*model)->ouster()) {
    const int columns = spec.columns > 0 ? spec.columns : 1024;
    return ouster_table(nominal_ouster_metadata(*ouster, columns, rate, "RNG19_RFL8_SIG16_NIR16"), *ouster,
                        (*model)->name);
  }
  const VelodyneModel& velodyne = *(*model)->velodyne();
  const Result<VelodyneCalibration> calibration =
      velodyne_calibration(velodyne, (*model)->name, spec.calibration);
  if (!calibration) return fail(calibration.error());
  return velodyne_table(velodyne, *calibration, rate, (*model)->name);
}

}  // namespace ca2
