#include <array>

#include "drivers/lidar/ouster/frame.h"

namespace ca2 {
namespace {

/// The returns of one column, gathered on the stack: appending them to the scan at once writes its memory
/// only once, where growing it first would write it twice.
struct Chunk {
  static constexpr std::size_t capacity = 1024;
  std::array<Eigen::Vector3f, capacity> points;
  std::array<float, capacity> intensity, range;
  std::array<std::uint16_t, capacity> ring;
  std::size_t size = 0;

  void append_to(Scan& scan, std::uint32_t column, std::int64_t time) {
    const auto n = static_cast<std::ptrdiff_t>(size);
    scan.points.insert(scan.points.end(), points.begin(), points.begin() + n);
    scan.intensity.insert(scan.intensity.end(), intensity.begin(), intensity.begin() + n);
    scan.range.insert(scan.range.end(), range.begin(), range.begin() + n);
    scan.ring.insert(scan.ring.end(), ring.begin(), ring.begin() + n);
    scan.column.insert(scan.column.end(), size, column);
    scan.time.insert(scan.time.end(), size, time);
    size = 0;
  }
};

/// Computes in double, rounds to float at the end. Points of range 0 are written too and then overwritten:
/// cheaper than a branch that is taken at random.
template <int returns>
void convert_column(const OusterFrame& frame, const OusterGeometry& geometry, std::size_t column,
                    Chunk& chunk) {
  const std::size_t first = column * static_cast<std::size_t>(frame.rows);
  const Eigen::Matrix3d& M = geometry.columns[column].M;
  const Eigen::Vector3d base = geometry.t + M * Eigen::Vector3d(geometry.origin_x, 0, geometry.origin_z);
  std::size_t n = 0;
  for (int row = 0; row < frame.rows; ++row) {
    const OusterGeometry::Row& r = geometry.rows[static_cast<std::size_t>(row)];
    const double x = M(0, 0) * r.a + M(0, 1) * r.b + M(0, 2) * r.c;
    const double y = M(1, 0) * r.a + M(1, 1) * r.b + M(1, 2) * r.c;
    const double z = M(2, 0) * r.a + M(2, 1) * r.b + M(2, 2) * r.c;
    for (int i = 0; i < returns; ++i) {
      const std::uint32_t mm = frame.range[i][first + static_cast<std::size_t>(row)];
      const double range = mm * 1e-3;
      const double p = range - geometry.origin_range;
      chunk.points[n] =
          Eigen::Vector3f(static_cast<float>(p * x + base.x()), static_cast<float>(p * y + base.y()),
                          static_cast<float>(p * z + base.z()));
      chunk.range[n] = static_cast<float>(range);
      chunk.intensity[n] = frame.reflectivity[i][first + static_cast<std::size_t>(row)];
      chunk.ring[n] = static_cast<std::uint16_t>(row);
      n += mm != 0;
    }
  }
  chunk.size = n;
}

/// The same returns in the same order, unhurried.
void add_exact(const OusterFrame& frame, const OusterGeometry& geometry, bool dual,
               std::vector<ExactReturn>& out) {
  for (int column = 0; column < frame.columns; ++column) {
    for (int row = 0; row < frame.rows; ++row) {
      for (int i = 0; i < (dual ? 2 : 1); ++i) {
        const std::uint32_t mm = frame.range[i][static_cast<std::size_t>(column) * frame.rows + row];
        if (mm != 0) out.push_back({geometry.point(row, column, mm * 1e-3), mm * 1e-3});
      }
    }
  }
}

}  // namespace

LidarScan make_scan(const OusterFrame& frame, const OusterGeometry& geometry, bool second_returns,
                    bool exact) {
  const bool dual = second_returns && !frame.range[1].empty();
  const std::size_t capacity =
      static_cast<std::size_t>(frame.rows) * static_cast<std::size_t>(frame.columns) * (dual ? 2 : 1);
  LidarScan out;
  Scan& scan = out.scan;
  scan.rings = frame.rows;
  scan.columns = frame.columns;
  scan.points.reserve(capacity);
  scan.intensity.reserve(capacity);
  scan.range.reserve(capacity);
  scan.ring.reserve(capacity);
  scan.column.reserve(capacity);
  scan.time.reserve(capacity);
  Chunk chunk;
  for (std::size_t column = 0; column < frame.status.size(); ++column) {
    if (frame.status[column] == 0) continue;
    if (dual) {
      convert_column<2>(frame, geometry, column, chunk);
    } else {
      convert_column<1>(frame, geometry, column, chunk);
    }
    chunk.append_to(scan, static_cast<std::uint32_t>(column),
                    static_cast<std::int64_t>(frame.timestamp[column]));
  }
  if (exact) add_exact(frame, geometry, dual, out.exact);
  return out;
}

}  // namespace ca2
