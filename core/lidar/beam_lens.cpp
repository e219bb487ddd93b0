#include "core/lidar/beam_lens.h"

#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

namespace ca2 {
namespace {

/// From the manual's table: offset over the tangent of the elevation, the same for all beams to 0.1 mm.
constexpr double vlp16_radius = 0.0418;

/// Beams of the VLP-16: 16, every 2 degrees, the lowest at -15.
constexpr double lowest = -15, spacing = 2;
constexpr std::size_t beams = 16;
/// Where few returns have to be: an eighth of the beams' spacing, millimetres at arm's length.
constexpr double stray = 0.25;  // deg
/// What the mean of a ring is off by: coordinates in whole millimetres, tables of 0.1 degrees.
constexpr double inexact = 0.06;  // deg
/// Four rings of another LiDAR are that close to such places by chance once in 80 000 times.
constexpr std::size_t least_rings = 4;

std::string folded(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte)) out += static_cast<char>(std::tolower(byte));
  }
  return out;
}

}  // namespace

double beam_lens_radius(std::string_view model) {
  return folded(model) == "vlp16" ? vlp16_radius : 0;
}

double beam_lens_radius(std::span<const float> elevations) {
  struct Ring {
    std::size_t count = 0;
    double off = 0;  // deg, sum
  };
  std::array<Ring, beams> rings;
  std::size_t kept = 0;
  for (const float elevation : elevations) {
    const double place = (double{elevation} * 180 / std::numbers::pi - lowest) / spacing;
    const double nearest = std::round(place), off = spacing * (place - nearest);
    if (!(nearest >= 0) || nearest >= static_cast<double>(beams) || std::abs(off) > stray) continue;
    Ring& ring = rings[static_cast<std::size_t>(nearest)];
    ++ring.count;
    ring.off += off;
    ++kept;
  }
  if (kept * 100 < elevations.size() * 99) return 0;
  std::size_t seen = 0;
  for (const Ring& ring : rings) {
    // A few returns are hardly a ring.
    if (ring.count == 0 || ring.count * beams * 10 < kept) continue;
    if (std::abs(ring.off) > inexact * static_cast<double>(ring.count)) return 0;
    ++seen;
  }
  return seen >= least_rings ? vlp16_radius : 0;
}

}  // namespace ca2
