/// @file Poses and the state's names in the messages' formats.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "core/capture/status.h"
#include "core/geometry/pose.h"

namespace ca2 {

class pose_v1_t;

/// {"translation": [x, y, z], "rotation": {"x": , "y": , "z": , "w": }}
nlohmann::json pose_to_json(const Pose& pose);
/// Throws nlohmann::json::exception where it is not one.
Pose pose_from_json(const nlohmann::json& json);

pose_v1_t pose_to_lcm(const Pose& pose);
Pose pose_from_lcm(const pose_v1_t& message);

/// An unknown name is `waiting`.
CaptureState state_of(std::string_view name);

}  // namespace ca2
