#include <algorithm>

#include "core/lidar/scan_grid.h"

namespace ca2 {
namespace {

constexpr int kMaxRings = 1024;  // more is a damaged file: no sensor has them
constexpr float kBin = 0.0005f;  // rad, a quarter of the closest beams sold (0.1 deg)

RingIds given_rings(const Scan& scan) {
  RingIds ids;
  if (scan.ring.size() != scan.size()) return ids;
  int highest = -1;
  for (const std::uint16_t ring : scan.ring) highest = std::max(highest, static_cast<int>(ring));
  if (highest >= kMaxRings) return ids;
  ids.rings = std::max(highest + 1, std::min(scan.rings, kMaxRings));
  ids.beams = true;
  ids.ring = scan.ring;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!is_return(scan.points[i])) ids.ring[i] = RingIds::none;
  }
  return ids;
}

/// Beams leave empty elevations between them: groups of filled bins, parted by empty ones, are rings.
/// Returns the ring of each bin, or nothing when the elevations run into each other (beams that start away
/// from the origin are seen under an elevation that changes with range).
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
  const bool parted = rings >= 4 && rings <= 256 && static_cast<float>(widest) * kBin < 0.01f;
  return parted ? ring_of_bin : std::vector<int>{};
}

/// Slices of equal elevation with a column's height or about twice it: as many as leave few cells empty.
int slice_count(std::size_t returns, float field) {
  const double cell =
      1.5 * field * 2 * std::numbers::pi / static_cast<double>(std::max<std::size_t>(returns, 1));
  return std::clamp(static_cast<int>(field / std::sqrt(2 * cell)), 8, 256);
}

}  // namespace

RingIds find_rings(const Scan& scan) {
  RingIds ids = given_rings(scan);
  if (ids.beams) return ids;
  ids.ring.assign(scan.size(), RingIds::none);
  std::vector<float> elevation(scan.size(), 0);
  float low = 2, high = -2;
  int returns = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    if (!is_return(p)) continue;
    elevation[i] = std::atan2(p.z(), std::hypot(p.x(), p.y()));
    low = std::min(low, elevation[i]);
    high = std::max(high, elevation[i]);
    ids.ring[i] = 0;
    ++returns;
  }
  if (returns == 0) return ids;
  std::vector<int> histogram(static_cast<std::size_t>((high - low) / kBin) + 1, 0);
  const auto bin = [&](std::size_t i) { return static_cast<std::size_t>((elevation[i] - low) / kBin); };
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (ids.ring[i] != RingIds::none) ++histogram[bin(i)];
  }
  if (const std::vector<int> ring_of_bin = cluster_bins(histogram, returns); !ring_of_bin.empty()) {
    ids.beams = true;
    ids.rings = *std::max_element(ring_of_bin.begin(), ring_of_bin.end()) + 1;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      if (ids.ring[i] == RingIds::none) continue;
      const int ring = ring_of_bin[bin(i)];
      ids.ring[i] = ring < 0 ? RingIds::none : static_cast<std::uint16_t>(ring);
    }
    return ids;
  }
  ids.rings = slice_count(static_cast<std::size_t>(returns), high - low);
  const float slice = (high - low) / static_cast<float>(ids.rings) * 1.0001f + 1e-9f;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (ids.ring[i] != RingIds::none) ids.ring[i] = static_cast<std::uint16_t>((elevation[i] - low) / slice);
  }
  return ids;
}

}  // namespace ca2
