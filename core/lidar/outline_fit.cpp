#include "core/lidar/outline_fit.h"

namespace ca2 {
namespace {

std::vector<PlaneSample> samples_of(const std::vector<PatchRay>& rays) {
  std::vector<PlaneSample> samples;
  samples.reserve(rays.size());
  for (const PatchRay& ray : rays) {
    // A ray through the board is worth as much as a return on it; a missing
    // return is weaker (black print), and something before the plane may hide
    // either. In twentieths.
    const int weight = ray.end == RayEnd::on       ? 20
                       : ray.end == RayEnd::behind ? -20
                       : ray.end == RayEnd::absent ? -6
                                                   : -1;
    samples.push_back({ray.u, ray.v, weight});
  }
  return samples;
}

}  // namespace

Placed place_rectangle(const PatchContext& context, const Plane& plane, const Eigen::Vector3d& centre,
                       const LookAround& look) {
  Placed placed{PatchFrame(plane, centre), {}, {}};
  placed.rays = view_patch(context.image, placed.frame, look.radius, look.band, look.most);
  placed.rectangle = fit_rectangle(samples_of(placed.rays), context.width, context.height);
  return placed;
}

Eigen::Vector3d centre_of(const Placed& placed) {
  return placed.frame.origin + placed.rectangle.u * placed.frame.e_u + placed.rectangle.v * placed.frame.e_v;
}

Pose pose_of(const Placed& placed, const Plane& plane) {
  const double c = placed.rectangle.cosine, s = placed.rectangle.sine;
  const Eigen::Vector3d z = -plane.normal, centre = centre_of(placed);
  Eigen::Vector3d x = c * placed.frame.e_u + s * placed.frame.e_v;
  x = (x - x.dot(z) * z).normalized();
  Pose pose;
  pose.R << x, z.cross(x), z;
  pose.t = centre - plane.distance(centre) * plane.normal;
  return pose;
}

}  // namespace ca2
