/// @file The text behind read_intrinsics (rig.h).
#pragma once

#include <filesystem>
#include <string>

#include "core/camera/camera_model.h"
#include "core/types/result.h"

namespace ca2 {

/// px, of a rig's pictures; as read_png.
inline constexpr int max_image_side = 30000;

/// Intrinsics from the text of a ROS camera_info, Kalibr camchain or OpenCV calibration file; `file` only
/// names it in errors. Every problem is reported, ErrorCode::config. A distortion that no model of ours
/// expresses exactly is refused.
Result<Camera> parse_intrinsics(const std::string& text, const std::filesystem::path& file,
                                const std::string& camera = {});

}  // namespace ca2
