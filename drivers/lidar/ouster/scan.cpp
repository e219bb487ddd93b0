#include <array>

#include "drivers/lidar/ouster/frame.h"

namespace ca2 {
namespace {

/// The returns of one column, gathered on the stack: appending them to the scan at once writes its memory
/// only once, where growing it first would write it twice.
struct Chunk {
  static constexpr std::size_t capacity = 1024;  // two returns of the most rows metadata may have
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

/// Points of one column and return, all rows, in double. Rows without
/// a return are computed too, which is cheaper than a branch taken at random.
struct ColumnPoints {
  Eigen::ArrayXd x, y, z, range;

  void compute(const OusterFrame& frame, const OusterGeometry& geometry, int ret, std::size_t column) {
    using Millimetres = Eigen::Array<std::uint32_t, Eigen::Dynamic, 1>;
    const std::size_t first = column * static_cast<std::size_t>(frame.rows);
    const Eigen::Map<const Millimetres> mm(&frame.range[ret][first], frame.rows);
    const Eigen::Matrix3d& M = geometry.columns[column].M;
    const Eigen::Vector3d base = geometry.t + M * Eigen::Vector3d(geometry.origin_x, 0, geometry.origin_z);
    range = mm.cast<std::int32_t>().cast<double>() *
            1e-3;  // at most 20 bits: the signed conversion is the fast one
    p_ = range - geometry.origin_range;
    x = (p_ * (M(0, 0) * geometry.a + M(0, 1) * geometry.b + M(0, 2) * geometry.c) + base.x());
    y = (p_ * (M(1, 0) * geometry.a + M(1, 1) * geometry.b + M(1, 2) * geometry.c) + base.y());
    z = (p_ * (M(2, 0) * geometry.a + M(2, 1) * geometry.b + M(2, 2) * geometry.c) + base.z());
  }

 private:
  Eigen::ArrayXd p_;
};

template <int returns>
void gather_column(const OusterFrame& frame, std::size_t column, const std::array<ColumnPoints, 2>& points,
                   Chunk& chunk) {
  const std::size_t first = column * static_cast<std::size_t>(frame.rows);
  std::size_t n = 0;
  for (int row = 0; row < frame.rows; ++row) {
    for (int i = 0; i < returns; ++i) {
      const ColumnPoints& p = points[i];
      const std::size_t at = first + static_cast<std::size_t>(row);
      chunk.points[n] = Eigen::Vector3d(p.x[row], p.y[row], p.z[row]).cast<float>();
      chunk.range[n] = static_cast<float>(p.range[row]);
      chunk.intensity[n] = frame.reflectivity[i][at];
      chunk.ring[n] = static_cast<std::uint16_t>(row);
      n += frame.range[i][at] != 0;
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

void make_scan(const OusterFrame& frame, const OusterGeometry& geometry, bool second_returns, bool exact,
               LidarScan& out) {
  const bool dual = second_returns && !frame.range[1].empty();
  const std::size_t capacity =
      static_cast<std::size_t>(frame.rows) * static_cast<std::size_t>(frame.columns) * (dual ? 2 : 1);
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
  std::array<ColumnPoints, 2> points;
  for (std::size_t column = 0; column < frame.status.size(); ++column) {
    if (frame.status[column] == 0) continue;
    points[0].compute(frame, geometry, 0, column);
    if (dual) {
      points[1].compute(frame, geometry, 1, column);
      gather_column<2>(frame, column, points, chunk);
    } else {
      gather_column<1>(frame, column, points, chunk);
    }
    chunk.append_to(scan, static_cast<std::uint32_t>(column),
                    static_cast<std::int64_t>(frame.timestamp[column]));
  }
  if (exact) add_exact(frame, geometry, dual, out.exact);
}

}  // namespace ca2
