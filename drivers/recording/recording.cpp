#include "drivers/recording/recording.h"

#include "ca2_version.h"
#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/io/yaml_text.h"

namespace ca2 {

LidarModelSpec Recording::model(const std::string& lidar) const {
  const RigLidar& described = rig.lidars.at(lidar);
  LidarModelSpec spec;
  spec.model = described.model;
  // An absolute path stays what it is.
  if (!described.metadata.empty()) spec.metadata = directory / described.metadata;
  if (!described.calibration.empty()) spec.calibration = directory / described.calibration;
  return spec;
}

Result<Recording> open_recording(const std::filesystem::path& directory) {
  const std::filesystem::path file = directory / "recording.yaml";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    return fail(ErrorCode::io, directory.string(), "has no recording.yaml",
                "is this a recording's directory?");
  }
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  Recording recording;
  recording.directory = directory;
  Result<Rig> rig = parse_rig(*text, file, {"start", "software"});
  if (!rig) return fail(rig.error());
  recording.rig = std::move(*rig);
  const Result<YamlNode> root = parse_yaml(*text, file.string());
  if (!root) return fail(root.error());
  YamlReader reader(file.string());
  const auto start = reader.integer(reader.require(*root, "start", "the recording"), 0,
                                    std::numeric_limits<std::int64_t>::max());
  if (!reader.problems().empty()) return fail(ErrorCode::config, reader.problems());
  recording.start = *start;
  return recording;
}

std::string recording_text(const Rig& rig, std::int64_t start) {
  return write_rig(rig) + "software: " + yaml_string("ca2 " CA2_VERSION) +
         "\nstart: " + std::to_string(start) + "  # ns UTC\n";
}

}  // namespace ca2
