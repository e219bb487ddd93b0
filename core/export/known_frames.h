/// @file Transforms that people know from elsewhere: a robot's URDF, or a YAML list.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/export/frame_graph.h"
#include "core/types/result.h"

namespace ca2 {

/// The fixed joints of a URDF (its moving ones have no pose to know), or the `extrinsics:` of a YAML file,
/// keys as in a rig: parent, child, translation, rotation. Told apart by what the file begins with. Every
/// problem is reported, ErrorCode::config.
Result<std::vector<FrameTransform>> read_known_frames(const std::filesystem::path& file);
Result<std::vector<FrameTransform>> parse_known_frames(const std::string& text, const std::string& name);

}  // namespace ca2
