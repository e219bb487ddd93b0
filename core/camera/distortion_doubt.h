/// @file Numbers that make a camera, but hardly a lens.
#pragma once

#include <optional>
#include <string>

#include "core/camera/camera_model.h"

namespace ca2 {

/// Why the distortion can hardly be a lens's, with the angle and the coefficient: it folds back before the
/// picture's sides (fisheyes may end there, once they have seen almost all in front of them), or draws what
/// is there half as far again as without it. Nothing where it is believable. Without a picture size the
/// principal point is taken for the middle.
std::optional<std::string> distortion_doubt(const Camera& camera);

}  // namespace ca2
