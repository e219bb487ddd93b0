#include <algorithm>

#include "core/lidar/beam_circle.h"
#include "core/lidar/scan_grid.h"
#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

constexpr int kMaxRings = 1024;  // more is a damaged file: no sensor has them
constexpr float kBin = 0.0005f;  // rad, a quarter of the closest beams sold (0.1 deg)
constexpr int kWidestRing = 5;   // bins

CA2_HOT_LOOP int highest_of(const std::uint16_t* __restrict ring, std::size_t size) {
  std::uint16_t highest = 0;
  for (std::size_t i = 0; i < size; ++i) highest = ring[i] > highest ? ring[i] : highest;
  return size == 0 ? -1 : highest;
}

RingIds given_rings(const Scan& scan) {
  RingIds ids;
  if (scan.ring.size() != scan.size()) return ids;
  const int highest = highest_of(scan.ring.data(), scan.ring.size());
  if (highest >= kMaxRings) return ids;
  ids.rings = std::max(highest + 1, std::min(scan.rings, kMaxRings));
  ids.beams = true;
  return ids;
}

/// Beams leave empty elevations between them: groups of filled bins, parted by
/// empty ones, are rings. Returns the ring of each bin, or nothing when the
/// elevations run into each other (beams that start elsewhere are seen under an
/// elevation that changes with range).
std::vector<int> cluster_bins(const std::vector<int>& histogram, int returns) {
  std::vector<int> ring_of_bin(histogram.size(), -1);
  const int stray = std::max(1, returns / 20000);  // moved by noise of near points
  int rings = 0, widest = 0, width = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    if (histogram[i] > stray) {
      rings += width++ == 0;
      widest = std::max(widest, width);
      ring_of_bin[i] = rings - 1;
    } else {
      width = 0;
    }
  }
  int kept = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) kept += ring_of_bin[i] >= 0 ? histogram[i] : 0;
  const bool parted = rings >= 4 && rings <= 256 && widest <= kWidestRing && kept * 100 > returns * 99;
  return parted ? ring_of_bin : std::vector<int>{};
}

/// Do all returns of each ring lie on a cone z = height + slope * rho? Noise
/// along a beam does not leave it, so this holds to the rounding of the file
/// for the right rings, and for no others.
template <class RingOf>
bool on_cones(const Scan& scan, int rings, RingOf ring_of) {
  struct Sums {
    double n = 0, r = 0, z = 0, rr = 0, rz = 0, zz = 0;
  };
  std::vector<Sums> sums(static_cast<std::size_t>(rings));
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    if (!is_return(p) || p.squaredNorm() > 400) continue;
    const double r = std::hypot(static_cast<double>(p.x()), static_cast<double>(p.y())), z = p.z();
    Sums& s = sums[static_cast<std::size_t>(ring_of(i))];
    s.n += 1, s.r += r, s.z += z, s.rr += r * r, s.rz += r * z, s.zz += z * z;
  }
  constexpr double kRounding = 0.006;  // m
  double residual = 0, count = 0;
  for (const Sums& s : sums) {
    if (s.n < 3) continue;
    const double rr = s.rr - s.r * s.r / s.n, rz = s.rz - s.r * s.z / s.n, zz = s.zz - s.z * s.z / s.n;
    residual += std::max(0.0, zz - rz * rz / std::max(rr, 1e-9));
    count += s.n;
  }
  return count > 0 && residual < count * kRounding * kRounding;
}

/// Clouds that keep a place for every measurement say the ring by the index:
/// firing after firing, or ring after ring. True when one of the usual numbers
/// of beams fits.
bool rings_by_index(const Scan& scan, RingIds& ids) {
  for (const int rings : {16, 32, 40, 64, 80, 128}) {
    const std::size_t columns = scan.size() / static_cast<std::size_t>(rings);
    if (columns < 90 || scan.size() % static_cast<std::size_t>(rings) != 0) continue;
    const auto firing = [&](std::size_t i) { return i % static_cast<std::size_t>(rings); };
    const auto row = [&](std::size_t i) { return i / columns; };
    const bool by_firing = on_cones(scan, rings, firing);
    if (!by_firing && !on_cones(scan, rings, row)) continue;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      if (is_return(scan.points[i]))
        ids.found[i] = static_cast<std::uint16_t>(by_firing ? firing(i) : row(i));
    }
    ids.rings = rings;
    ids.beams = true;
    return true;
  }
  return false;
}

/// Slices of equal elevation with a column's height or about twice it: as many
/// as leave few cells empty.
int slice_count(std::size_t returns, float field) {
  const double cell =
      1.5 * field * 2 * std::numbers::pi / static_cast<double>(std::max<std::size_t>(returns, 1));
  const double slices = field > 0 ? field / std::sqrt(2 * cell) : 0;  // all may lie on one cone
  return static_cast<int>(std::clamp(slices, 8.0, 256.0));
}

/// Elevations of the returns by bins.
class Elevations {
 public:
  Elevations(const Scan& scan, const std::vector<std::uint16_t>& place, BeamCircle from)
      : values_(scan.size(), 0) {
    float high = -2;
    low_ = 2;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      if (place[i] == RingIds::none) continue;
      values_[i] = from.elevation(scan.points[i]);
      low_ = std::min(low_, values_[i]);
      high = std::max(high, values_[i]);
    }
    field_ = high - low_;
  }
  /// In units of `size` [rad] from the lowest one.
  std::size_t bin(std::size_t i, float size) const {
    return static_cast<std::size_t>((values_[i] - low_) / size);
  }
  float field() const { return field_; }

 private:
  std::vector<float> values_;
  float low_ = 0, field_ = 0;
};

/// Rings as the beams that begin there leave them; false: they do not.
bool rings_by_elevation(const Elevations& elevations, int returns, RingIds& ids) {
  std::vector<int> histogram(static_cast<std::size_t>(elevations.field() / kBin) + 1, 0);
  for (std::size_t i = 0; i < ids.found.size(); ++i) {
    if (ids.found[i] != RingIds::none) ++histogram[elevations.bin(i, kBin)];
  }
  const std::vector<int> ring_of_bin = cluster_bins(histogram, returns);
  if (ring_of_bin.empty()) return false;
  ids.beams = true;
  ids.rings = *std::max_element(ring_of_bin.begin(), ring_of_bin.end()) + 1;
  for (std::size_t i = 0; i < ids.found.size(); ++i) {
    if (ids.found[i] == RingIds::none) continue;
    const int ring = ring_of_bin[elevations.bin(i, kBin)];
    ids.found[i] = ring < 0 ? RingIds::none : static_cast<std::uint16_t>(ring);
  }
  return true;
}

}  // namespace

RingIds find_rings(const Scan& scan) {
  RingIds ids = given_rings(scan);
  if (ids.beams) return ids;
  ids.found.assign(scan.size(), RingIds::none);
  if (rings_by_index(scan, ids)) return ids;
  int returns = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!is_return(scan.points[i])) continue;
    ids.found[i] = 0;
    ++returns;
  }
  if (returns == 0) return ids;
  const Elevations from_origin(scan, ids.found, {});
  if (rings_by_elevation(from_origin, returns, ids)) return ids;
  if (const auto circle = find_beam_circle(scan.points)) {
    if (rings_by_elevation({scan, ids.found, *circle}, returns, ids)) return ids;
  }
  ids.rings = slice_count(static_cast<std::size_t>(returns), from_origin.field());
  const float slice = from_origin.field() / static_cast<float>(ids.rings) * 1.0001f + 1e-9f;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (ids.found[i] != RingIds::none) ids.found[i] = static_cast<std::uint16_t>(from_origin.bin(i, slice));
  }
  return ids;
}

}  // namespace ca2
