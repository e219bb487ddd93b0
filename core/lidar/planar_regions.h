/// @file Planar pieces of a ring image that end where the board would.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/plane.h"
#include "core/lidar/ring_image.h"
#include "core/lidar/ring_runs.h"

namespace ca2 {

/// A connected planar piece. Where the board would have many cells, only every
/// few of them are listed.
struct PlanarRegion {
  Plane plane;                       ///< sensor frame
  std::vector<std::uint32_t> cells;  ///< of the ring image, those visited within the board's reach
  float area = 0;                    ///< m^2, of all the surface that the visited cells stand for
};

struct PlanarRegions {
  std::vector<PlanarRegion> regions;
  float noise = 0;  ///< m, typical distance of returns from a smooth surface in this scan
};

/// What growing works on; kept from scan to scan for its memory.
struct RegionMemory {
  std::vector<RingRun> runs;
  std::vector<std::uint8_t> claims;   ///< [cell]
  std::vector<std::uint32_t> stamps;  ///< [cell] the region that last visited it
  std::uint32_t stamp = 0;
  std::vector<std::pair<int, int>> queue;
  std::vector<std::uint32_t> members;  ///< cells of the surface that is growing
};

/// Grows planes over the ring image from seeds laid a quarter of the board's
/// shorter side apart on runs of rings that are not longer than the board could
/// be, and keeps those whose surface is about the board's and does not go on
/// beyond it. `width`, `height` in m.
PlanarRegions find_planar_regions(const RingImage& image, double width, double height, RegionMemory& memory);

}  // namespace ca2
