/// @file The factory's calibration of a T265 in our terms.
#pragma once

#include <vector>

#include "drivers/camera/camera_source.h"
#include "drivers/camera/t265/messages.h"

namespace ca2::t265 {

/// What the device says about one fisheye.
struct FisheyeCalibration {
  CameraIntrinsics intrinsics;
  Extrinsics extrinsics;
};

/// "left" and "right", with T_first_this = T_left_right. ErrorCode::data where the numbers cannot be a
/// calibration: another model, no rotation, another reference, imagers a metre apart.
Result<std::vector<CameraStream>> camera_streams(const FisheyeCalibration& left,
                                                 const FisheyeCalibration& right);

}  // namespace ca2::t265
