#include "core/solve/rim_ends.h"

#include <algorithm>
#include <span>

#include "core/solve/rim_polygon.h"

namespace ca2 {
namespace {

/// Blurs are looked for from the first to the last of these by doubling, rad.
constexpr double least_blur = 1e-4, most_blur = 6.4e-3;
/// The odds from which on a ray is taken for a stray one.
constexpr double sure_odds = 20;
/// So few rays may be, lest rays that are all less sure than they should be are.
constexpr std::size_t rays_per_stray = 32;

RimPolygon possible_ends(std::span<const RimRay> rays, const EndSearch& search) {
  RimPolygon ends(search.middle, search.reach);
  for (const RimRay& ray : rays) {
    ends.cut(ray.weights, ray.bound + search.blur);
    if (ends.empty()) break;
  }
  return ends;
}

/// The rays that limit what is possible, by index. Where nothing is, the ray that takes the last of it, and
/// those that limit the rest until then: it contradicts them.
std::vector<std::size_t> limiting(std::span<const RimRay> rays, const EndSearch& search) {
  std::size_t count = rays.size();
  RimPolygon ends(search.middle, search.reach);
  for (std::size_t i = 0; i < count; ++i) {
    ends.cut(rays[i].weights, rays[i].bound + search.blur);
    if (ends.empty()) count = i;
  }
  if (ends.empty()) ends = possible_ends(rays.first(count), search);
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < count; ++i) {
    if (ends.limited_by(rays[i].weights, rays[i].bound + search.blur)) list.push_back(i);
  }
  if (count < rays.size()) list.push_back(count);
  return list;
}

/// What is possible with the ray at `index` a stray one.
RimPolygon with_stray(std::vector<RimRay>& rays, std::size_t index, const EndSearch& search) {
  const double bound = rays[index].bound;
  rays[index].bound += rays[index].slip;
  RimPolygon ends = possible_ends(rays, search);
  rays[index].bound = bound;
  return ends;
}

/// Takes one ray for what it is, if it is surely a stray one.
bool settle_stray(std::vector<RimRay>& rays, const EndSearch& search) {
  const double area = possible_ends(rays, search).area();
  const std::vector<std::size_t> candidates = limiting(rays, search);
  std::optional<std::size_t> stray;
  double most = sure_odds * area / search.stray_share;
  for (const std::size_t i : candidates) {
    const double other = with_stray(rays, i, search).area();
    if (!(other > most)) continue;
    most = other;
    stray = i;
  }
  if (stray) {
    rays[*stray].bound += rays[*stray].slip;
    return true;
  }
  if (area > 0) return false;
  for (const std::size_t i : candidates) {
    std::vector<RimRay> others = rays;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double other = possible_ends(others, search).area();
    if (!(other > most)) continue;
    most = other;
    stray = i;
  }
  if (!stray) return false;
  rays.erase(rays.begin() + static_cast<std::ptrdiff_t>(*stray));
  return true;
}

/// What is possible is as probable as it is large, and as its rays are.
RimPolygon::Moments moments_of(std::vector<RimRay>& rays, const EndSearch& search, const RimPolygon& ends) {
  const RimPolygon::Moments all = ends.moments();
  double total = ends.area();
  if (!(search.stray_share > 0) || !(total > 0)) return all;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();  // from that of all
  Eigen::Matrix2d second = total * all.covariance;
  for (const std::size_t i : limiting(rays, search)) {
    const RimPolygon other = with_stray(rays, i, search);
    const double weight = search.stray_share * other.area();
    if (!(weight > 0)) continue;
    const RimPolygon::Moments one = other.moments();
    const Eigen::Vector2d off = one.mean - all.mean;
    total += weight;
    mean += weight * off;
    second += weight * (one.covariance + off * off.transpose());
  }
  mean /= total;
  return {all.mean + mean, second / total - mean * mean.transpose()};
}

}  // namespace

std::optional<RimEnds> find_rim_ends(std::vector<RimRay> rays, EndSearch search) {
  std::size_t strays = search.stray_share > 0 ? 1 + rays.size() / rays_per_stray : 0;
  while (strays > 0 && settle_stray(rays, search)) --strays;
  RimPolygon ends = possible_ends(rays, search);
  double needed = 0;
  if (ends.empty()) {
    while (ends.empty() && search.blur < most_blur) {
      search.blur = std::max(2 * search.blur, least_blur);
      ends = possible_ends(rays, search);
    }
    if (ends.empty()) return std::nullopt;
    // What is just possible is a point, and much too sure: twice the blur that makes it possible.
    needed = search.blur;
    search.blur *= 2;
    ends = possible_ends(rays, search);
  }
  const RimPolygon::Moments moments = moments_of(rays, search, ends);
  return RimEnds{moments.mean, moments.covariance, needed};
}

}  // namespace ca2
