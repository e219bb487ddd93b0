/// @file What a rig says that cannot be meant, though nothing forbids it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/session/rig.h"
#include "core/types/result.h"

namespace ca2 {

/// A warning of a lens that can hardly be one.
std::optional<Problem> camera_doubt(const Camera& camera, const std::string& file);

/// Warnings, of every camera and of a LiDAR's metadata too. A LiDAR's model that is not known here is none of
/// the known ones', a slip of the pen included: what is known of a model's beams is not used then.
std::vector<Problem> rig_doubts(const Rig& rig, const std::string& file);

}  // namespace ca2
