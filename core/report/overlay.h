/// @file A LiDAR's points drawn on a camera's picture.
#pragma once

#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/types/image.h"
#include "core/types/scan.h"

namespace ca2 {

/// The colour of a share 0 (near, red) .. 1 (far, blue), as 8-bit red, green, blue.
struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};
Colour range_colour(double share);

struct Overlay {
  Image image;      ///< colour, 8 bits, size of the picture
  double near = 0;  ///< m: the range drawn in red (2nd percentile of the points drawn)
  double far = 0;   ///< m: the range drawn in blue (98th percentile)
  int drawn = 0;    ///< points inside the picture
};

/// The picture in grey with every point of the scan that projects into it, coloured by range, far ones first.
Overlay draw_overlay(const Image& image, const Camera& camera, const Scan& scan, const Pose& T_camera_lidar);

}  // namespace ca2
