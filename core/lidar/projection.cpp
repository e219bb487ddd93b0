#include "core/lidar/projection.h"

#include <algorithm>
#include <limits>

#include "core/lidar/scan_grid.h"
#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// Rings that lie off their cone by more than this are not turned about the frame's z axis, rad rms.
constexpr double largest_rest = 5e-4;

/// Per ring the straight line z = height + slope * rho through its returns:
/// beams of one ring lie on a cone whose apex need not be the origin. A ring
/// whose returns are all equally far says nothing about the apex, which then is
/// taken for the origin: the ridge stands for a prior of about 0.2 m and returns that lie 2 mm off the cone.
/// Some hundred returns of a ring tell it: noise along a beam does not leave the cone.
void fit_cones(const Scan& scan, Projection& out) {
  out.slope.assign(static_cast<std::size_t>(out.rings), std::numeric_limits<float>::quiet_NaN());
  out.height.assign(static_cast<std::size_t>(out.rings), 0);
  out.by_elevation.clear();
  for (int ring = 0; ring < out.rings; ++ring) {
    double n = 0, sum_r = 0, sum_rr = 0, sum_z = 0, sum_rz = 0, sum_zz = 0;
    // Rings with few returns tell by all they have.
    for (int step = std::max(1, out.columns / 192); step > 0 && n<24; step = step> 1 ? 1 : 0) {
      n = sum_r = sum_rr = sum_z = sum_rz = sum_zz = 0;
      for (int column = 0; column < out.columns; column += step) {
        const auto add = [&](const Eigen::Vector3f& p) {
          const double r = std::sqrt(p.x() * p.x() + p.y() * p.y());
          n += 1, sum_r += r, sum_rr += r * r, sum_z += p.z(), sum_rz += r * p.z();
          sum_zz += double{p.z()} * p.z();
        };
        const std::size_t cell = out.index(ring, column);
        if (!out.one_per_cell()) {
          for (const std::uint32_t i : out.cell(cell)) add(scan.points[i]);
        } else if (out.range[cell] != 0) {
          add(out.point[cell]);
        }
      }
    }
    if (n == 0 || sum_rr == 0) continue;
    const double weight = n + (out.beams ? 1e-4 : 1e12), determinant = weight * sum_rr - sum_r * sum_r;
    double height = (sum_z * sum_rr - sum_r * sum_rz) / determinant;
    double slope = (sum_rz - height * sum_r) / sum_rr;
    if (sum_zz - height * sum_z - slope * sum_rz > largest_rest * largest_rest * sum_rr) {
      height = 0;
      slope = sum_rz / sum_rr;
    }
    const auto k = static_cast<std::size_t>(ring);
    out.height[k] = static_cast<float>(height);
    out.slope[k] = static_cast<float>(slope);
    out.by_elevation.push_back(ring);
  }
  std::sort(out.by_elevation.begin(), out.by_elevation.end(), [&](int a, int b) {
    return out.slope[static_cast<std::size_t>(a)] < out.slope[static_cast<std::size_t>(b)];
  });
}

/// Scans come column by column, and so are written one cell in every ring. Rings a power of two apart would
/// all fall into the same few lines of a cache; an odd number of its lines apart they fall into all of them.
int stride_of(int columns) {
  constexpr int in_line = 64 / sizeof(float);
  return ((columns + in_line - 1) / in_line | 1) * in_line;
}

/// Squared ranges (m^2); 0 for what has no place.
CA2_HOT_LOOP void square_ranges(std::size_t size, const float* __restrict points,
                                const std::uint16_t* __restrict ring, float* __restrict out) {
  for (std::size_t i = 0; i < size; ++i) {
    const float x = points[3 * i], y = points[3 * i + 1], z = points[3 * i + 2];
    out[i] = x * x + (y * y + z * z);  // as squaredNorm() adds them
  }
  for (std::size_t i = 0; i < size; ++i) {
    const bool good = (out[i] > least_square) & (out[i] < most_square);
    out[i] = good & (ring[i] != RingIds::none) ? out[i] : 0.0f;
  }
}

CA2_HOT_LOOP bool any_beyond(std::uint32_t count, std::size_t size, const std::uint32_t* __restrict column) {
  std::uint32_t highest = 0;
  for (std::size_t i = 0; i < size; ++i) highest = column[i] > highest ? column[i] : highest;
  return highest >= count;
}

/// Every return that has a place, with its cell and range (m), to `take`, until
/// that says false.
template <class Take>
bool for_each_return(const Scan& scan, const RingIds& rings, const ColumnIds& columns, int stride,
                     Take take) {
  constexpr std::size_t at_once = 512;
  float squares[at_once];
  std::uint32_t turned[at_once];
  // Plain pointers, as the compiler must not think that `take` moves the
  // arrays.
  const std::uint32_t* const shift = columns.shift.data();
  const auto count = static_cast<std::uint32_t>(columns.columns);
  for (std::size_t first = 0; first < scan.size(); first += at_once) {
    const std::size_t size = std::min(at_once, scan.size() - first);
    const std::uint16_t* const ring = rings.of(scan).data() + first;
    const std::uint32_t* column = columns.of(scan).data() + first;
    square_ranges(size, scan.points[first].data(), ring, squares);
    if (columns.backwards || any_beyond(count, size, column)) {
      for (std::size_t k = 0; k < size; ++k) {
        const std::uint32_t id = column[k] < count ? column[k] : column[k] % count;
        turned[k] = columns.backwards && id > 0 ? count - id : id;
      }
      column = turned;
    }
    for (std::size_t k = 0; k < size; ++k) {
      if (squares[k] == 0) continue;
      std::uint32_t id = column[k] + shift[ring[k]];
      if (id >= count) id -= count;
      const std::size_t cell = static_cast<std::size_t>(ring[k]) * stride + id;
      if (!take(static_cast<std::uint32_t>(first + k), cell, std::sqrt(squares[k]))) return false;
    }
  }
  return true;
}

/// One sweep of most sensors: a place for every cell. False when some cell has
/// two returns.
bool fill_one_per_cell(const Scan& scan, const RingIds& rings, const ColumnIds& columns, Projection& out) {
  const std::size_t cells = static_cast<std::size_t>(out.rings) * out.stride;
  out.first.clear();
  out.returns.resize(cells);
  out.range.assign(cells, 0.0f);
  std::uint32_t* const returns = out.returns.data();
  float* const ranges = out.range.data();
  out.point.resize(cells);
  Eigen::Vector3f* const points = out.point.data();
  const Eigen::Vector3f* const from = scan.points.data();
  return for_each_return(scan, rings, columns, out.stride,
                         [=](std::uint32_t i, std::size_t cell, float range) {
                           if (ranges[cell] != 0) return false;
                           returns[cell] = i;
                           points[cell] = from[i];
                           ranges[cell] = range;
                           return true;
                         });
}

/// Counting sort by cell; the scan's order is kept within a cell.
void fill_many_per_cell(const Scan& scan, const RingIds& rings, const ColumnIds& columns, Projection& out) {
  const std::size_t cells = static_cast<std::size_t>(out.rings) * out.stride;
  out.point = {};
  out.first.assign(cells + 1, 0);
  out.range.assign(cells, 0.0f);
  for_each_return(scan, rings, columns, out.stride, [&](std::uint32_t, std::size_t cell, float range) {
    ++out.first[cell + 1];
    if (out.range[cell] == 0 || range < out.range[cell]) out.range[cell] = range;
    return true;
  });
  for (std::size_t i = 1; i < out.first.size(); ++i) out.first[i] += out.first[i - 1];
  out.returns.resize(out.first.back());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  for_each_return(scan, rings, columns, out.stride, [&](std::uint32_t i, std::size_t cell, float) {
    out.returns[next[cell]++] = i;
    return true;
  });
}

}  // namespace

double Projection::column_angle() const {
  return 2 * std::numbers::pi / std::max(columns, 1);
}

Projection project_by_id(const Scan& scan, Projection spare) {
  RingIds rings = find_rings(scan);
  const ColumnIds columns = find_columns(scan, rings);
  Projection out = std::move(spare);
  out.rings = rings.rings;
  out.columns = columns.columns;
  out.stride = stride_of(out.columns);
  out.beams = rings.beams;
  if (!fill_one_per_cell(scan, rings, columns, out)) fill_many_per_cell(scan, rings, columns, out);
  fit_cones(scan, out);
  out.found_ring.reset();
  if (!rings.found.empty())
    out.found_ring = std::make_shared<const std::vector<std::uint16_t>>(std::move(rings.found));
  return out;
}

std::vector<float> intensity_image(const Projection& projection, const Scan& scan) {
  std::vector<float> image(projection.range.size(), 0.0f);
  if (scan.intensity.size() != scan.size()) return image;
  for (std::size_t cell = 0; cell < image.size(); ++cell) {
    float nearest = std::numeric_limits<float>::max();
    for (const std::uint32_t i : projection.cell(cell)) {
      const float range = scan.points[i].norm();
      if (range < nearest) nearest = range, image[cell] = scan.intensity[i];
    }
  }
  return image;
}

}  // namespace ca2
