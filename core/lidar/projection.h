/// @file The projection by ID: a scan as the picture its sensor took, ring x
/// column.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/types/scan.h"

namespace ca2 {

/// Which returns fall in which cell: [index(ring, column)]. Column 0 looks
/// backwards (azimuth pi) and columns rise clockwise seen from above, so that
/// the picture is not mirrored; rings keep the scan's ids. Beams of a ring that
/// look beside their column (Ouster's staggered beams, the HDL-64E's rotational
/// offsets) are shifted into line. A cell keeps all its returns: a gathered
/// scan has several sweeps.
struct Projection {
  int rings = 0;
  int columns = 0;     ///< of a full turn
  int stride = 0;      ///< cells from one ring to the next; those past `columns` are empty
  bool beams = false;  ///< rings are the sensor's, not just slices of elevation
  /// Indices of the scan, cell by cell; NaN and zero points are left out. Where
  /// no cell has two returns (one sweep), there is one place per cell, without
  /// a meaning for an empty one; else `first` says where a cell begins.
  std::vector<std::uint32_t> returns;
  std::vector<std::uint32_t> first;  ///< empty, or [cell], into `returns`; one more at the end
  /// m, [cell] of its return where no cell has two, ring by ring: a scan's own points lie column by column,
  /// each in another line of the cache. Empty where cells have several.
  std::vector<Eigen::Vector3f> point;
  std::vector<float> range;       ///< m, [cell] of its nearest return, from the
                                  ///< frame's origin; 0: none
  std::vector<float> slope;       ///< per ring: z = height + slope * horizontal
                                  ///< distance; NaN for an empty ring
  std::vector<float> height;      ///< m, per ring: where its beams start (they need
                                  ///< not pass the origin)
  std::vector<int> by_elevation;  ///< rings that have returns, lowest first
  /// By return, RingIds::none for those without a place; null: the scan's own. Rings that were found are
  /// counted in this scan: another one's may have other numbers. Candidates share it.
  std::shared_ptr<const std::vector<std::uint16_t>> found_ring;

  std::size_t index(int ring, int column) const { return static_cast<std::size_t>(ring) * stride + column; }
  bool one_per_cell() const { return first.empty(); }
  std::span<const std::uint32_t> cell(std::size_t i) const {
    if (one_per_cell()) return {&returns[i], static_cast<std::size_t>(range[i] != 0)};
    return std::span(returns).subspan(first[i], first[i + 1] - first[i]);
  }
  std::span<const std::uint32_t> cell(int ring, int column) const { return cell(index(ring, column)); }
  /// Of a return in a cell.
  const Eigen::Vector3f& point_of(std::uint32_t i, std::size_t cell, const Scan& scan) const {
    return one_per_cell() ? point[cell] : scan.points[i];
  }
  /// rad between neighbouring columns
  double column_angle() const;
};

/// Rings and columns as the scan names them; rings recovered from elevations
/// and columns from azimuths, at the resolution found in the data, where it
/// does not. Never fails: a scan without points has no cells. `spare`: a
/// projection that is no longer needed, for its memory.
Projection project_by_id(const Scan& scan, Projection spare = {});

/// Intensity of each cell's nearest return in the vendor's unit (zeros when not
/// known). 0 where nothing came back. [Projection::index(ring, column)]
std::vector<float> intensity_image(const Projection& projection, const Scan& scan);

}  // namespace ca2
