/// @file A LiDAR's points drawn on a camera's picture.
#pragma once

#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/report/evidence.h"
#include "core/types/image.h"
#include "core/types/scan.h"

namespace ca2 {

/// The colour of a share 0 (near, red) .. 1 (far, blue), as 8-bit red, green, blue.
struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};
Colour range_colour(double share);
/// -1 (nearer than expected, blue) over 0 (white) to 1 (farther, red).
Colour signed_colour(double share);

/// A point of the LiDAR that the camera sees.
struct SeenPoint {
  std::uint32_t index = 0;  ///< in the scan
  Eigen::Vector3d point;    ///< camera frame, m
  Eigen::Vector2d pixel;    ///< px
};

/// The points inside the picture that nothing hides from the camera. Points that fall in one and the same
/// pair of pixels are one point, the nearest.
std::vector<SeenPoint> seen_points(const Camera& camera, const Scan& scan, const Pose& T_camera_lidar);

struct Overlay {
  Image image;      ///< colour, 8 bits
  double near = 0;  ///< m: the range drawn in red (2nd percentile of the points drawn)
  double far = 0;   ///< m: the range drawn in blue (98th percentile)
};

/// The picture in grey, at most `width` px wide, with these points (px of the whole picture), coloured by
/// range, far ones first.
Overlay draw_overlay(const Image& image, const std::vector<SeenPoint>& points, int width);

/// The part of the picture that shows the board, `width` px wide: the LiDAR's points on it coloured by their
/// error, `scale` (m) at the ends of the colours, and an arrow from each corner along its error, `magnified`
/// so many times.
Image draw_residuals(const Image& image, const Camera& camera, const Pose& T_camera_lidar,
                     const std::vector<CornerError>& corners, const std::vector<BoardPointError>& points,
                     double scale, double magnified, int width);

/// Reduced to at most this many pixels across; smaller ones stay.
Image reduced(const Image& image, int width);

/// The scan from above and behind, in the camera's colours where the camera sees a point.
Image draw_cloud(const Image& image, const std::vector<SeenPoint>& seen, const Scan& scan,
                 const Pose& T_camera_lidar);
/// The seen points as a PLY file, binary, colours from the picture.
std::string coloured_ply(const Image& image, const std::vector<SeenPoint>& seen, const Scan& scan);

}  // namespace ca2
