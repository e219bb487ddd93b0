/// @file Format, size and rate of a V4L2 camera: what is wanted, and what the camera agrees to.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/pixel_formats/pixel_format.h"
#include "drivers/camera/v4l2/device.h"

namespace ca2 {

struct V4l2Wishes {
  std::string format;  ///< fourcc ("YUYV") or PFNC name; empty: uncompressed grey before colours before JPEG
  std::optional<int> width, height;
  std::optional<double> frame_rate;  ///< Hz
};

struct V4l2Agreement {
  const PixelFormat* format = nullptr;
  int width = 0, height = 0;
  std::size_t stride = 0;   ///< bytes; 0: JPEG
  bool full_range = false;  ///< of YUV
  double frame_rate = 0;    ///< Hz; 0: the camera does not tell
  std::string warning;      ///< what it would not agree to; empty: it agreed to all
};

/// Errors list what the camera can.
Result<V4l2Agreement> negotiate(const V4l2Device& device, const V4l2Wishes& wishes);

/// "YUYV 640x480 1280x720; MJPG 640x480 ...": for people.
std::string v4l2_abilities(const V4l2Device& device);

}  // namespace ca2
