/// @file What every model asks of its parameters.
#pragma once

#include <optional>
#include <string>

#include "core/camera/camera_model.h"

namespace ca2 {

/// Wrong count, a number that is not finite, or a focal length that is not positive: the reason, or nothing.
std::optional<std::string> common_invalid(const CameraModel& model, const CameraParameters& parameters);

}  // namespace ca2
