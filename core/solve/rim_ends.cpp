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

/// What is possible, and what would be with each of the rays that limit it a stray one.
class Limits {
 public:
  Limits(std::span<const RimRay> rays, const EndSearch& search) : ends(possible_ends(rays, search)) {
    if (!(search.stray_share > 0)) return;
    find(rays, search);
    std::vector<bool> limits(rays.size(), false);
    for (const std::size_t i : limiting) limits[i] = true;
    with_stray.reserve(limiting.size());
    RimPolygon others(search.middle, search.reach);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!limits[i]) others.cut(rays[i].weights, rays[i].bound + search.blur);
    }
    for (const std::size_t stray : limiting) {
      RimPolygon& with = with_stray.emplace_back(others);
      for (const std::size_t i : limiting)
        with.cut(rays[i].weights, rays[i].bound + search.blur + (i == stray ? rays[i].slip : 0));
    }
  }

  RimPolygon ends;
  std::vector<std::size_t> limiting;   ///< rays by index
  std::vector<RimPolygon> with_stray;  ///< by limiting ray; only where rays may be stray ones

 private:
  /// Where nothing is possible, the ray that takes the last of it, and those that limit the rest until then:
  /// it contradicts them.
  void find(std::span<const RimRay> rays, const EndSearch& search) {
    std::size_t count = rays.size();
    RimPolygon left = ends;
    if (ends.empty()) {
      left = RimPolygon(search.middle, search.reach);
      for (std::size_t i = 0; i < count; ++i) {
        RimPolygon next = left;
        next.cut(rays[i].weights, rays[i].bound + search.blur);
        if (next.empty()) {
          count = i;
        } else {
          left = next;
        }
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (left.limited_by(rays[i].weights, rays[i].bound + search.blur)) limiting.push_back(i);
    }
    if (count < rays.size()) limiting.push_back(count);
  }
};

/// Takes one ray for what it is, if it is surely a stray one.
bool settle_stray(std::vector<RimRay>& rays, const EndSearch& search, const Limits& limits) {
  const double area = limits.ends.area();
  std::optional<std::size_t> stray;
  double most = sure_odds * area / search.stray_share;
  for (std::size_t k = 0; k < limits.limiting.size(); ++k) {
    const double other = limits.with_stray[k].area();
    if (!(other > most)) continue;
    most = other;
    stray = limits.limiting[k];
  }
  if (stray) {
    rays[*stray].bound += rays[*stray].slip;
    return true;
  }
  if (area > 0) return false;
  for (const std::size_t i : limits.limiting) {
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
RimPolygon::Moments moments_of(const EndSearch& search, const Limits& limits) {
  const RimPolygon::Moments all = limits.ends.moments();
  double total = limits.ends.area();
  if (!(search.stray_share > 0) || !(total > 0)) return all;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();  // from that of all
  Eigen::Matrix2d second = total * all.covariance;
  for (const RimPolygon& other : limits.with_stray) {
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
  Limits limits(rays, search);
  for (; strays > 0 && settle_stray(rays, search, limits); --strays) limits = Limits(rays, search);
  double needed = 0;
  if (limits.ends.empty()) {
    while (limits.ends.empty() && search.blur < most_blur) {
      search.blur = std::max(2 * search.blur, least_blur);
      limits.ends = possible_ends(rays, search);
    }
    if (limits.ends.empty()) return std::nullopt;
    // What is just possible is a point, and much too sure: twice the blur that makes it possible.
    needed = search.blur;
    search.blur *= 2;
    limits = Limits(rays, search);
  }
  const RimPolygon::Moments moments = moments_of(search, limits);
  return RimEnds{moments.mean, moments.covariance, needed};
}

}  // namespace ca2
