#include "tools/ca2/lidar_file.h"

#include "core/types/counted.h"
#include "drivers/lidar/ouster/metadata.h"
#include "drivers/lidar/velodyne/calibration.h"

namespace ca2 {
namespace {

/// In the vendor's db.xml, which lists 64 lasers whatever the model has.
constexpr const char* boost = "boost_serialization";

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

/// A YAML file lists the model's lasers.
Result<std::string> velodyne_text(const std::string& text, const std::string& file) {
  if (text.find(boost) != std::string::npos) {
    constexpr int least = 16;
    const auto read = parse_velodyne_calibration(text, least, file);
    return read ? Result<std::string>("of one unit (db.xml)") : fail(read.error());
  }
  for (const int lasers : {128, 64, 32}) {
    if (parse_velodyne_calibration(text, lasers, file)) return counted(lasers, "laser");
  }
  const auto smallest = parse_velodyne_calibration(text, 16, file);
  if (!smallest) return fail(smallest.error());
  return counted(smallest->lasers.size(), "laser");
}

}  // namespace

std::optional<LidarFile> look_at_lidar_file(const std::filesystem::path& file, const std::string& text) {
  const auto has = [&](const char* word) { return text.find(word) != std::string::npos; };
  const std::string name = file.string();
  if (has("\"beam_altitude_angles\"")) {
    const Result<OusterMetadata> metadata = parse_ouster_metadata(text, name);
    if (!metadata) return LidarFile{"Ouster metadata", fail(metadata.error()), {}};
    return LidarFile{"Ouster metadata", text_of(*metadata), warnings_of(*metadata, name)};
  }
  if (has(boost) || has("vert_correction"))
    return LidarFile{"Velodyne calibration", velodyne_text(text, name), {}};
  return std::nullopt;
}

std::vector<Problem> metadata_doubts(const std::filesystem::path& file) {
  const Result<OusterMetadata> metadata = read_ouster_metadata(file);
  return metadata ? warnings_of(*metadata, file.string()) : std::vector<Problem>();
}

}  // namespace ca2
