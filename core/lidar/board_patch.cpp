#include "core/lidar/board_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/lidar/covered_returns.h"
#include "core/lidar/outline_fit.h"
#include "core/lidar/ray_plane.h"

namespace ca2 {
namespace {

// Rays looked at: most pieces are dismissed at the first look; the second finds
// the rim to a few millimetres.
constexpr std::size_t kFirstLook = 300, kSecondLook = 2000;

/// The mean of the region's points, and then of those within `reach` of it:
/// arms and other leads pull less.
Eigen::Vector3d dense_centre(const PatchContext& context, const PlanarRegion& region, float reach) {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  for (const float limit : {1e9f, reach, reach}) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float count = 0;
    for (const std::uint32_t cell : region.cells) {
      const Eigen::Vector3f& p = context.image.point(cell);
      if ((p - centre).squaredNorm() < limit * limit) sum += p, ++count;
    }
    if (count > 0) centre = sum / count;
  }
  return centre.cast<double>();
}

/// rad between the ring of a cell and the next.
double row_angle_at(const PatchContext& context, std::uint32_t cell) {
  return context.image.row_angle[static_cast<std::size_t>(context.image.row(cell))];
}

Evidence weigh(const PatchContext& context, const Placed& placed, double margin) {
  if (placed.rays.empty()) return {};
  const double near_row =
      placed.frame.origin.norm() * row_angle_at(context, placed.rays[placed.rays.size() / 2].cell);
  // Beyond the rim's mixed pixels and what the rectangle's place is uncertain
  // by, and wide enough for a ring.
  const double beyond = margin + 0.5 * std::min(near_row, 0.03);
  const double rim = std::max(0.15 * std::min(context.width, context.height), 1.3 * near_row);
  double on = 0, hollow = 0;
  std::array<double, 4> solid{}, seen{};
  int last_row = -1;
  Evidence evidence;
  for (const PatchRay& ray : placed.rays) {
    int side = 0;
    const double distance = outside(context, placed.rectangle, ray, side);
    if (distance < -margin) {
      if (ray.end == RayEnd::on) {
        ++on;
        evidence.rows += ray.row != last_row;
        last_row = ray.row;
      } else {
        hollow += ray.end == RayEnd::behind ? 1 : ray.end == RayEnd::front ? 0.5 : 0.3;
      }
    } else if (distance > beyond && distance < beyond + rim) {
      // What stands before the rim hides it: hands, or another thing.
      if (ray.end == RayEnd::front) continue;
      seen[static_cast<std::size_t>(side)] += 1;
      if (ray.end == RayEnd::on) solid[static_cast<std::size_t>(side)] += 1;
      // What falls away as slowly as a body's next face is not a free rim.
      const bool next_face = ray.end == RayEnd::behind && -ray.distance < 2 * distance;
      if (next_face) solid[static_cast<std::size_t>(side)] += 0.5;
    }
  }
  evidence.fill = on / std::max(on + hollow, 1.0);
  evidence.least_free = 1;
  for (std::size_t s = 0; s < 4; ++s) {
    // No ray passed this side: the field of view ends there, and the surface
    // may well go on.
    const double free = seen[s] < 2 ? 0.4 : 1 - solid[s] / seen[s];
    evidence.free += free / 4;
    evidence.least_free = std::min(evidence.least_free, free);
  }
  return evidence;
}

/// Is the cell beside one that is off the plane? Its own return may be a
/// mixture of both. Judged by the neighbours, so that it does not depend on the
/// return's own noise.
bool beside_other(const PatchContext& context, const Plane& plane, const PatchRay& ray, double band) {
  const RingImage& image = context.image;
  const int row = ray.row, column = image.column(ray.cell, row);
  // Where rings lie farther apart than a beam is wide, the next one tells
  // nothing.
  const bool close_rows = image.range[ray.cell] * image.row_angle[static_cast<std::size_t>(row)] < 0.03f;
  for (const auto& [dr, dc] : {std::pair{0, -1}, {0, 1}, {-1, 0}, {1, 0}}) {
    if (row + dr < 0 || row + dr >= image.rows || (dr != 0 && !close_rows)) continue;
    const std::size_t i = image.index(row + dr, image.wrap(column + dc));
    if (image.range[i] > 0 && std::abs(plane.distance(image.point(i).cast<double>())) > band) return true;
  }
  return false;
}

/// Returns with their points in double precision.
struct Inside {
  std::vector<std::uint32_t> returns;
  std::vector<Eigen::Vector3d> points;
};

/// Of all rays, those that meet the plane inside the rectangle, a margin from its rim: their returns within
/// `band` of it (m, along the normal, the same to both sides, as the rays were viewed with), but for
/// `covered` ones (sorted).
Inside returns_inside(const PatchContext& context, const Placed& placed, double margin, double band,
                      const std::vector<std::uint32_t>& covered) {
  Inside inside;
  const Plane& plane = placed.frame.plane;
  for (const PatchRay& ray : placed.rays) {
    int side = 0;
    if (ray.end != RayEnd::on || outside(context, placed.rectangle, ray, side) > -margin) continue;
    if (beside_other(context, plane, ray, band)) continue;
    for (const std::uint32_t i : context.projection.cell(ray.cell)) {
      const Eigen::Vector3d point = context.projection.point_of(i, ray.cell, context.scan).cast<double>();
      if (!(std::abs(plane.distance(point)) < band)) continue;
      if (std::binary_search(covered.begin(), covered.end(), i)) continue;
      inside.returns.push_back(i);
      inside.points.push_back(point);
    }
  }
  return inside;
}

std::string explain(const Evidence& evidence, const BoardCandidate& candidate) {
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu returns in %d rings, outline filled %.0f %%, rim free "
                "%.0f %% (least side %.0f %%), "
                "noise %.1f mm",
                candidate.returns.size(), evidence.rows, 100 * evidence.fill, 100 * evidence.free,
                100 * evidence.least_free, 1e3 * candidate.rms);
  return text;
}

/// The same rectangle with all rays within `radius` (m) of its centre.
Placed with_all_rays(const PatchContext& context, const Placed& placed, double radius, double band) {
  Placed all{PatchFrame(placed.frame.plane, centre_of(placed)), {}, placed.rectangle};
  all.rectangle.u = all.rectangle.v = 0;
  all.rays = view_patch(context.image, all.frame, radius, band, SIZE_MAX);
  return all;
}

}  // namespace

std::optional<FirstLook> look_at_region(const PatchContext& context, const PlanarRegion& region) {
  const double diagonal = std::hypot(context.width, context.height);
  const double band = std::clamp(3.5 * context.noise, 0.02, 0.08);
  const Eigen::Vector3d centre = dense_centre(context, region, static_cast<float>(0.6 * diagonal));
  const double gap = std::max<double>(context.image.column_angle,
                                      std::min(row_angle_at(context, region.cells.front()), 0.015));
  const double margin =
      std::clamp(0.5 * centre.norm() * gap + 0.01, 0.015, 0.15 * std::min(context.width, context.height));
  std::vector<Eigen::Vector3d> points;
  for (const std::uint32_t cell : region.cells) points.push_back(context.image.point(cell).cast<double>());
  FirstLook look{place_rectangle(context, fit_ranges(points, region.plane).plane, centre,
                                 {0.95 * diagonal, band, kFirstLook}),
                 {},
                 margin,
                 0};
  look.evidence = weigh(context, look.placed, margin);
  const Evidence& e = look.evidence;
  // Too hollow, or the plane goes on around it.
  if (e.rows < 2 || e.fill < 0.4 || e.free < 0.2) return std::nullopt;
  look.score = e.fill * e.fill * e.free * (0.5 + 0.5 * e.least_free);
  return look;
}

std::optional<BoardCandidate> judge_look(const PatchContext& context, const FirstLook& look) {
  // The plane of the board's own returns, and its own noise.
  const double first_band = std::clamp(3.5 * context.noise, 0.02, 0.08);
  const double diagonal = std::hypot(context.width, context.height);
  const Inside first = returns_inside(
      context, with_all_rays(context, look.placed, 0.5 * diagonal, first_band), look.margin, first_band, {});
  if (first.points.size() < 6) return std::nullopt;
  const auto near_plane = [](const RangeFit& fit, const Eigen::Vector3d& at) {
    return std::clamp(4 * fit.sigma * std::abs(fit.plane.normal.dot(at.normalized())), 0.015, 0.09);
  };
  RangeFit fit = fit_ranges(first.points, look.placed.frame.plane);
  const double band = near_plane(fit, centre_of(look.placed));
  const Placed placed =
      place_rectangle(context, fit.plane, centre_of(look.placed), {0.8 * diagonal, band, kSecondLook});
  const Evidence evidence = weigh(context, placed, look.margin);
  if (evidence.rows < 2 || evidence.fill < 0.5 || evidence.free < 0.3) return std::nullopt;
  const Placed all = with_all_rays(context, placed, covered_reach(context.width, context.height), band);
  BoardCandidate candidate;
  candidate.covered = find_covered_returns(context.projection, context.image, fit.plane, centre_of(placed),
                                           all.rays, fit.sigma);
  Inside inside = returns_inside(context, all, look.margin, band, candidate.covered);
  if (inside.returns.size() < 8) return std::nullopt;
  candidate.returns = std::move(inside.returns);
  fit = fit_ranges(inside.points, placed.frame.plane);
  candidate.plane = fit.plane;
  candidate.rms = fit.rms;
  candidate.T_lidar_board = pose_of(placed, fit.plane);
  const double smooth = std::min(1.0, 1.6 * context.noise / std::max(fit.rms, 1e-4));
  const auto count = static_cast<double>(candidate.returns.size());
  candidate.score = evidence.fill * evidence.fill * evidence.free * (0.5 + 0.5 * evidence.least_free) *
                    smooth * count / (count + 25);
  candidate.why = explain(evidence, candidate);
  return candidate;
}

}  // namespace ca2
