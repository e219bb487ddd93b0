/// @file The projection by ID: a scan as the picture its sensor took, ring x column.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/scan.h"

namespace ca2 {

/// Which returns fall in which cell. Column 0 looks backwards (azimuth pi) and columns rise clockwise seen
/// from above, so that the picture is not mirrored; rings keep the scan's ids. Beams of a ring that look
/// beside their column (Ouster's staggered beams, the HDL-64E's rotational offsets) are shifted into line.
/// A cell keeps all its returns: a gathered scan has several sweeps.
struct Projection {
  int rings = 0;
  int columns = 0;                     ///< of a full turn
  bool beams = false;                  ///< rings are the sensor's, not just slices of elevation
  std::vector<std::uint32_t> first;    ///< [ring * columns + column], into `returns`; one more at the end
  std::vector<std::uint32_t> returns;  ///< indices of the scan, cell by cell; NaN and zero points left out
  std::vector<float> slope;   ///< per ring: z = height + slope * horizontal distance; NaN for an empty ring
  std::vector<float> height;  ///< m, per ring: where its beams start (they need not pass the origin)
  std::vector<int> by_elevation;  ///< rings that have returns, lowest first

  std::span<const std::uint32_t> cell(int ring, int column) const {
    const std::size_t i = static_cast<std::size_t>(ring) * columns + column;
    return std::span(returns).subspan(first[i], first[i + 1] - first[i]);
  }
  /// rad between neighbouring columns
  double column_angle() const;
};

/// Rings and columns as the scan names them; rings recovered from elevations and columns from azimuths, at
/// the resolution found in the data, where it does not. Never fails: a scan without points has no cells.
Projection project_by_id(const Scan& scan);

/// One number per cell, of its nearest return: range (m, from the frame's origin), and intensity in the
/// vendor's unit (zeros when not known). 0 where nothing came back. [ring * columns + column]
std::vector<float> range_image(const Projection& projection, const Scan& scan);
std::vector<float> intensity_image(const Projection& projection, const Scan& scan);

}  // namespace ca2
