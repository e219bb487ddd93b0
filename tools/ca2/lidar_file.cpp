#include "tools/ca2/lidar_file.h"

#include "core/types/counted.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/metadata.h"
#include "drivers/lidar/velodyne/calibration.h"

namespace ca2 {
namespace {

std::vector<Problem> warnings_of(const OusterMetadata& metadata, const std::string& file) {
  std::vector<Problem> problems;
  for (const std::string& warning : metadata.warnings) problems.push_back({file, warning, {}});
  return problems;
}

std::string text_of(const OusterMetadata& metadata) {
  std::string text = metadata.prod_line.empty() ? "a sensor without a name" : metadata.prod_line;
  for (const std::string* more : {&metadata.firmware, &metadata.lidar_mode, &metadata.profile}) {
    if (!more->empty()) text += ", " + *more;
  }
  return text + ", " + counted(metadata.altitude.size(), "beam");
}

/// Which models it has lasers enough for: a unit's XML lists 64 whatever its model has.
Result<std::string> velodyne_text(const std::string& text, const std::string& file) {
  std::string fits;
  std::optional<Error> error;
  for (const LidarModel& model : lidar_models()) {
    if (!model.velodyne()) continue;
    const auto read = parse_velodyne_calibration(text, model.velodyne()->lasers, file);
    if (read) {
      fits += (fits.empty() ? "fits " : ", ") + model.name;
    } else if (!error) {
      error = read.error();
    }
  }
  if (fits.empty() && error) return fail(*std::move(error));
  return fits;
}

}  // namespace

std::optional<LidarFile> look_at_lidar_file(const std::filesystem::path& file, const std::string& text) {
  const std::string name = file.string();
  if (is_ouster_metadata(text)) {
    const Result<OusterMetadata> metadata = parse_ouster_metadata(text, name);
    if (!metadata) return LidarFile{"Ouster metadata", fail(metadata.error()), {}};
    return LidarFile{"Ouster metadata", text_of(*metadata), warnings_of(*metadata, name)};
  }
  if (is_velodyne_calibration(text)) return LidarFile{"Velodyne calibration", velodyne_text(text, name), {}};
  return std::nullopt;
}

std::vector<Problem> metadata_doubts(const std::filesystem::path& file) {
  const Result<OusterMetadata> metadata = read_ouster_metadata(file);
  return metadata ? warnings_of(*metadata, file.string()) : std::vector<Problem>();
}

}  // namespace ca2
