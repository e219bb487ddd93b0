/// @file The board's outline laid over what the rays around a plane tell.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/pose.h"
#include "core/lidar/patch_view.h"
#include "core/lidar/rectangle_fit.h"
#include "core/types/scan.h"

namespace ca2 {

/// What is judged, and against what.
struct PatchContext {
  const Scan& scan;
  const Projection& projection;
  const RingImage& image;
  double width, height;  ///< m, the board
  double noise;          ///< m, of this scan
};

/// A rectangle in a plane's coordinates, with the rays it was fitted to.
struct Placed {
  PatchFrame frame;
  std::vector<PatchRay> rays;
  PlaneRectangle rectangle;
};

/// Which rays are looked at.
struct LookAround {
  double radius;            ///< m, from the centre: those that meet the plane there
  double band;              ///< m, returns so near the plane are on it
  std::size_t most = 2000;  ///< about so many; the cost is linear in them
};

/// The board's rectangle where it covers most returns on the plane and fewest
/// rays through it.
Placed place_rectangle(const PatchContext& context, const Plane& plane, const Eigen::Vector3d& centre,
                       const LookAround& look);

/// The rectangle's centre, m, sensor frame.
Eigen::Vector3d centre_of(const Placed& placed);

/// T_lidar_board of the rectangle, moved onto `plane` (a refit of the one it
/// was placed in).
Pose pose_of(const Placed& placed, const Plane& plane);

/// Distance (m) by which a ray passes outside the rectangle, negative inside,
/// and beyond which of its sides (0..3). Asked for every ray.
inline double outside(const PatchContext& context, const PlaneRectangle& rectangle, const PatchRay& ray,
                      int& side) {
  double x = 0, y = 0;
  rectangle.local(ray.u, ray.v, x, y);
  const double dx = std::abs(x) - context.width / 2, dy = std::abs(y) - context.height / 2;
  side = dx > dy ? (x > 0 ? 0 : 1) : (y > 0 ? 2 : 3);
  return std::max(dx, dy);
}

}  // namespace ca2
