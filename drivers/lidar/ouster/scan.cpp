#include <algorithm>
#include <array>

#include "drivers/lidar/avx512.h"
#include "drivers/lidar/lanes.h"
#include "drivers/lidar/ouster/column_returns.h"
#include "drivers/lidar/ouster/frame.h"

namespace ca2 {

CA2_LANES void detail::project_ouster_column(const OusterGeometry& geometry, std::size_t column,
                                             const std::uint32_t* ranges, int rows, FiredBeams& out) {
  const Eigen::Matrix3f M = geometry.columns[column].turn;
  const Eigen::Vector3f base = geometry.columns[column].base;
  const auto origin = static_cast<float>(geometry.origin_range);
  const bool upright = geometry.columns[column].upright;
  for (int row = 0; row < rows; row += lanes::count) {
    lanes::Floats range, a, b, c;
    lanes::load(range, ranges + row);
    lanes::load(a, geometry.a_lanes.data() + row);
    lanes::load(b, geometry.b_lanes.data() + row);
    lanes::load(c, geometry.c_lanes.data() + row);
    range = range / 1000.0f;
    const lanes::Floats p = range - origin;
    lanes::Floats x = M(0, 0) * a + M(0, 1) * b, y = M(1, 0) * a + M(1, 1) * b, z = c;
    if (!upright) {
      // Else multiplied by 0 or 1.
      x = x + M(0, 2) * c;
      y = y + M(1, 2) * c;
      z = M(2, 0) * a + M(2, 1) * b + M(2, 2) * c;
    }
    lanes::store(out.x + row, p * x + base.x());
    lanes::store(out.y + row, p * y + base.y());
    lanes::store(out.z + row, p * z + base.z());
    lanes::store(out.range + row, range);
  }
}

namespace {

/// What is the same for every column.
struct RowNames {
  std::array<std::uint16_t, FiredBeams::most> ring;

  RowNames() {
    for (std::size_t row = 0; row < ring.size(); ++row) ring[row] = static_cast<std::uint16_t>(row);
  }
};

void add_column(const OusterFrame& frame, const OusterGeometry& geometry, int ret, std::size_t column,
                ReturnWriter& writer) {
  static const RowNames rows;
  const std::size_t first = column * static_cast<std::size_t>(frame.rows);
  // All rows are measured at once.
  FiredNames names{&frame.range[ret][first],
                   &frame.reflectivity[ret][first],
                   rows.ring.data(),
                   nullptr,
                   static_cast<std::uint32_t>(column),
                   static_cast<std::int64_t>(frame.timestamp[column]),
                   frame.rows};
#if defined(__x86_64__)
  static const bool avx512 = has_avx512();
  if (avx512) {
    writer.add_by(frame.rows, [&](const detail::ReturnTargets& out, std::size_t at) {
      return detail::write_ouster_column_avx512(geometry, column, names, out, at);
    });
    return;
  }
#endif
  std::array<std::uint32_t, FiredBeams::most> range;
  std::array<std::uint8_t, FiredBeams::most> reflectivity;
  if (frame.rows % lanes::count != 0) {
    // The last lanes would reach into the next column, or beyond the last one.
    range.fill(0);
    reflectivity.fill(0);
    std::copy_n(names.counts, frame.rows, range.begin());
    std::copy_n(names.intensity, frame.rows, reflectivity.begin());
    names.counts = range.data();
    names.intensity = reflectivity.data();
  }
  FiredBeams beams;
  detail::project_ouster_column(geometry, column, names.counts, frame.rows, beams);
  writer.add(beams, names);
}

/// The same returns in the same order, unhurried.
void add_exact(const OusterFrame& frame, const OusterGeometry& geometry, int returns,
               std::vector<ExactReturn>& out) {
  for (int column = 0; column < frame.columns; ++column) {
    for (int ret = 0; ret < returns; ++ret) {
      for (int row = 0; row < frame.rows; ++row) {
        const std::uint32_t mm = frame.range[ret][static_cast<std::size_t>(column) * frame.rows + row];
        if (mm != 0) out.push_back({geometry.point(row, column, mm * 1e-3), mm * 1e-3});
      }
    }
  }
}

}  // namespace

void make_scan(const OusterFrame& frame, const OusterGeometry& geometry, bool second_returns, bool exact,
               LidarScan& out) {
  const int returns = second_returns && !frame.range[1].empty() ? 2 : 1;
  out.scan.rings = frame.rows;
  out.scan.columns = frame.columns;
  ReturnWriter writer;
  writer.begin(out.scan, frame.range[0].size() * static_cast<std::size_t>(returns));
  for (std::size_t column = 0; column < frame.status.size(); ++column) {
    if (frame.status[column] == 0) continue;
    for (int ret = 0; ret < returns; ++ret) add_column(frame, geometry, ret, column, writer);
  }
  writer.finish();
  if (exact) add_exact(frame, geometry, returns, out.exact);
}

}  // namespace ca2
