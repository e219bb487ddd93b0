/// @file What the rays around a place in a plane tell: on it, through it, or
/// stopped before it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/plane.h"
#include "core/lidar/ring_image.h"

namespace ca2 {

enum class RayEnd : std::uint8_t {
  on,      ///< on the plane, within its noise
  behind,  ///< went through the plane: nothing is there
  front,   ///< something stands before the plane: unknown
  absent,  ///< nothing came back: most likely nothing is there, or it is black
};

/// Where a cell's ray meets the plane. Not where its noisy point lies: that
/// would cut the rim by noise.
struct PatchRay {
  float u, v;      ///< m, in the plane, from PatchFrame::origin
  float distance;  ///< m, of the return from the plane, positive towards the
                   ///< sensor; 0 when absent
  RayEnd end;
  std::uint16_t row;   ///< of the ring image
  std::uint32_t cell;  ///< of the ring image
};

/// Coordinates in a plane: e_u x e_v points away from the sensor.
struct PatchFrame {
  Plane plane;
  Eigen::Vector3d origin, e_u, e_v;

  PatchFrame(const Plane& plane, const Eigen::Vector3d& near_point);
};

/// The rays that meet the plane within `radius` (m) of the frame's origin;
/// about `most` of them, evenly thinned, row by row. `band`: m, returns so near
/// the plane are on it.
std::vector<PatchRay> view_patch(const RingImage& image, const PatchFrame& frame, double radius, double band,
                                 std::size_t most);

}  // namespace ca2
