/// @file Lens distortion as OpenCV and ROS name it.
#pragma once

#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/types/result.h"

namespace ca2 {

struct OpencvDistortion {
  std::string ros_name;  ///< sensor_msgs' distortion_model
  bool fisheye = false;  ///< of cv::fisheye
  std::vector<double> coefficients;
};

/// ErrorCode::refused for models that OpenCV does not have; `format` is named in the message.
Result<OpencvDistortion> opencv_distortion(const Camera& camera, const std::string& format);

}  // namespace ca2
