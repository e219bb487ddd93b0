/// @file Poses and the two keys they are written as: `translation: [x, y, z]`, `rotation: {x, y, z, w}`.
#pragma once

#include <optional>
#include <string>

#include "core/geometry/pose.h"
#include "core/io/yaml_reader.h"

namespace ca2 {

/// No two sensors of a rig are further apart, m.
inline constexpr double max_sensor_distance = 1e4;

/// Reads both keys of a map. The rotation is settled: writing the pose and reading it again gives the same
/// bits.
std::optional<Pose> read_pose(YamlReader& reader, const YamlNode& map, std::string_view what);

/// "{x: 0, y: 0, z: 0, w: 1}" and "[x, y, z]", exact.
std::string rotation_text(const Pose& pose);
std::string translation_text(const Pose& pose);

}  // namespace ca2
