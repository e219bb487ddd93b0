#include "daemon/sensors/ouster_metadata.h"

#include "core/io/files.h"
#include "daemon/log.h"

namespace ca2 {

namespace fs = std::filesystem;

bool asks_for_metadata(const RigLidar& lidar) {
  const auto driver = lidar.source.find("driver"), host = lidar.source.find("host");
  return lidar.metadata.empty() && driver != lidar.source.end() && driver->second == "ouster" &&
         host != lidar.source.end() && !host->second.empty();
}

fs::path kept_metadata(const fs::path& state, const std::string& lidar) {
  return fs::absolute(state) / "lidars" / (lidar + ".json");
}

Rig with_kept_metadata(Rig rig, const fs::path& state) {
  for (auto& [name, lidar] : rig.lidars) {
    if (asks_for_metadata(lidar)) lidar.metadata = kept_metadata(state, name).string();
  }
  return rig;
}

Result<void> fetch_metadata(const std::string& host, const fs::path& file,
                            const OusterConfigOptions& options) {
  const auto sensor = OusterConfig::connect(host, options);
  const Result<std::string> text = sensor ? sensor->read_metadata() : fail(sensor.error());
  std::error_code error;
  if (!text) {
    if (!fs::exists(file, error)) return fail(text.error());
    log::warning("sensor", text.error().text() + "; its metadata of before is used");
    return {};
  }
  fs::create_directories(file.parent_path(), error);
  return write_atomically(file, *text);
}

}  // namespace ca2
