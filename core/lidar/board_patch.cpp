#include "core/lidar/board_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/lidar/outline_fit.h"
#include "core/lidar/ray_plane.h"

namespace ca2 {
namespace {

// Rays looked at: most pieces are dismissed at the first look; the second finds the rim to a few millimetres.
constexpr std::size_t kFirstLook = 600, kSecondLook = 2000;

/// The mean of the points, and then of those within `reach` of it: arms and other leads pull less.
Eigen::Vector3d dense_centre(const std::vector<Eigen::Vector3d>& points, double reach) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (double limit : {1e9, reach, reach}) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (const Eigen::Vector3d& p : points) {
      if ((p - centre).norm() < limit) sum += p, ++count;
    }
    if (count > 0) centre = sum / count;
  }
  return centre;
}

/// rad between the ring of a cell and the next.
double row_angle_at(const PatchContext& context, std::uint32_t cell) {
  return context.image.row_angle[static_cast<std::size_t>(context.image.row(cell))];
}

/// How the rectangle is filled and how free its sides are, each 0..1.
struct Evidence {
  double fill = 0, free = 0, least_free = 0;
  int on = 0;
  int rows = 0;  ///< rings with returns on the board
};

Evidence weigh(const PatchContext& context, const Placed& placed, double margin) {
  if (placed.rays.empty()) return {};
  const double near_row =
      placed.frame.origin.norm() * row_angle_at(context, placed.rays[placed.rays.size() / 2].cell);
  // Beyond the rim's mixed pixels and what the rectangle's place is uncertain by, and wide enough for a ring.
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
        const int row = context.image.row(ray.cell);
        evidence.rows += row != last_row;
        last_row = row;
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
  evidence.on = static_cast<int>(on);
  evidence.fill = on / std::max(on + hollow, 1.0);
  evidence.least_free = 1;
  for (std::size_t s = 0; s < 4; ++s) {
    // No ray passed this side: the field of view ends there, and the surface may well go on.
    const double free = seen[s] < 2 ? 0.4 : 1 - solid[s] / seen[s];
    evidence.free += free / 4;
    evidence.least_free = std::min(evidence.least_free, free);
  }
  return evidence;
}

/// Is the cell beside one that is off the plane? Its own return may be a mixture of both. Judged by the
/// neighbours, so that it does not depend on the return's own noise.
bool beside_other(const PatchContext& context, const Plane& plane, std::uint32_t cell, double band) {
  const RingImage& image = context.image;
  const int row = image.row(cell), column = image.column(cell);
  // Where rings lie farther apart than a beam is wide, the next one tells nothing.
  const bool close_rows = image.range[cell] * image.row_angle[static_cast<std::size_t>(row)] < 0.03f;
  for (const auto& [dr, dc] : {std::pair{0, -1}, {0, 1}, {-1, 0}, {1, 0}}) {
    if (row + dr < 0 || row + dr >= image.rows || (dr != 0 && !close_rows)) continue;
    const std::size_t i = image.index(row + dr, image.wrap(column + dc));
    if (image.range[i] > 0 && std::abs(plane.distance(image.point(i).cast<double>())) > band) return true;
  }
  return false;
}

/// All returns whose ray meets the plane inside the rectangle, a margin from its rim, and that lie within
/// `band` of it (m, along the normal, the same to both sides).
std::vector<std::uint32_t> returns_inside(const PatchContext& context, const Placed& placed, double margin,
                                          double band) {
  std::vector<std::uint32_t> list;
  const double radius =
      std::hypot(context.width, context.height) / 2 + std::hypot(placed.rectangle.u, placed.rectangle.v);
  for (const PatchRay& ray : view_patch(context.image, placed.frame, radius, band, SIZE_MAX)) {
    int side = 0;
    if (ray.end != RayEnd::on || outside(context, placed.rectangle, ray, side) > -margin) continue;
    if (beside_other(context, placed.frame.plane, ray.cell, band)) continue;
    const int row = context.image.row(ray.cell);
    const int column = context.image.column(ray.cell);
    for (const std::uint32_t i :
         context.projection.cell(context.image.ring[static_cast<std::size_t>(row)], column)) {
      if (std::abs(placed.frame.plane.distance(context.scan.points[i].cast<double>())) < band)
        list.push_back(i);
    }
  }
  return list;
}

std::vector<Eigen::Vector3d> points_of(const Scan& scan, const std::vector<std::uint32_t>& returns) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(returns.size());
  for (const std::uint32_t i : returns) points.push_back(scan.points[i].cast<double>());
  return points;
}

/// Not worth a second round: too hollow, or the plane goes on around it.
bool hopeless(const Evidence& evidence) {
  return evidence.rows < 2 || evidence.fill < 0.4 || evidence.free < 0.2;
}

std::string explain(const Evidence& evidence, const BoardCandidate& candidate) {
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu returns in %d rings, outline filled %.0f %%, rim free %.0f %% (least side %.0f %%), "
                "noise %.1f mm",
                candidate.returns.size(), evidence.rows, 100 * evidence.fill, 100 * evidence.free,
                100 * evidence.least_free, 1e3 * candidate.rms);
  return text;
}

}  // namespace

std::optional<BoardCandidate> judge_region(const PatchContext& context, const PlanarRegion& region) {
  const double diagonal = std::hypot(context.width, context.height);
  double band = std::clamp(3.5 * context.noise, 0.02, 0.08);
  std::vector<Eigen::Vector3d> points;
  for (const std::uint32_t cell : region.cells) points.push_back(context.image.point(cell).cast<double>());
  Eigen::Vector3d centre = dense_centre(points, 0.6 * diagonal);
  RangeFit fit = fit_ranges(points, region.plane);
  std::vector<std::uint32_t> returns;
  std::optional<Placed> placed;
  double margin = 0;
  // The second round sees the plane of the board's own returns, and its own noise.
  for (int round = 0; round < 2; ++round) {
    const double range = centre.norm();
    // The beam's footprint and what the rectangle's place is uncertain by.
    const double gap = std::max<double>(context.image.column_angle,
                                        std::min(row_angle_at(context, region.cells.front()), 0.015));
    margin = std::clamp(0.5 * range * gap + 0.01, 0.015, 0.15 * std::min(context.width, context.height));
    placed = place_rectangle(context, fit.plane, centre, (round == 0 ? 0.95 : 0.8) * diagonal, band,
                             round == 0 ? kFirstLook : kSecondLook);
    returns = returns_inside(context, *placed, margin, band);
    if (returns.size() < 8) return std::nullopt;
    if (round == 0 && hopeless(weigh(context, *placed, margin))) return std::nullopt;
    points = points_of(context.scan, returns);
    fit = fit_ranges(points, placed->frame.plane);
    centre = centre_of(*placed);
    const double facing = std::abs(fit.plane.normal.dot(centre.normalized()));
    band = std::clamp(4 * fit.sigma * facing, 0.015, 0.09);
  }
  const Evidence evidence = weigh(context, *placed, margin);
  if (evidence.rows < 2 || evidence.fill < 0.5 || evidence.free < 0.3) return std::nullopt;
  BoardCandidate candidate;
  candidate.plane = fit.plane;
  candidate.returns = std::move(returns);
  candidate.rms = fit.rms;
  candidate.T_lidar_board = pose_of(*placed, fit.plane);
  const double smooth = std::min(1.0, 1.6 * context.noise / std::max(fit.rms, 1e-4));
  const auto count = static_cast<double>(candidate.returns.size());
  candidate.score = evidence.fill * evidence.fill * evidence.free * (0.5 + 0.5 * evidence.least_free) *
                    smooth * count / (count + 25);
  candidate.why = explain(evidence, candidate);
  return candidate;
}

}  // namespace ca2
