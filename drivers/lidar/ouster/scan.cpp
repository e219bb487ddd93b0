#include <algorithm>
#include <array>

#include "drivers/lidar/lanes.h"
#include "drivers/lidar/ouster/frame.h"
#include "drivers/lidar/return_writer.h"

namespace ca2 {
namespace {

/// One return of a column as the frame has it, readable in whole lanes.
struct ColumnPixels {
  const std::uint32_t* range;  ///< mm
  const std::uint8_t* reflectivity;
  int rows;
};

/// The geometry's formula in single precision: within 2e-7 of the range, 20 um at 100 m, where the sensor's
/// step is 1 mm.
/// Rows without a return are computed too, which is cheaper than a branch taken at random.
CA2_LANES void project_column(const OusterGeometry& geometry, std::size_t column, const ColumnPixels& pixels,
                              FiredBeams& out) {
  const Eigen::Matrix3f M = geometry.columns[column].M.cast<float>();
  const Eigen::Vector3f base =
      (geometry.t + geometry.columns[column].M * Eigen::Vector3d(geometry.origin_x, 0, geometry.origin_z))
          .cast<float>();
  const auto origin = static_cast<float>(geometry.origin_range);
  // As nearly all sensors are set up, z is that of the head; what is left out below is multiplied by 0 or 1.
  const bool upright = M.row(2) == Eigen::RowVector3f(0, 0, 1) && M.col(2) == Eigen::Vector3f(0, 0, 1);
  for (int row = 0; row < pixels.rows; row += lanes::count) {
    lanes::Floats range, a, b, c;
    lanes::load(range, pixels.range + row);
    lanes::load(a, geometry.a_lanes.data() + row);
    lanes::load(b, geometry.b_lanes.data() + row);
    lanes::load(c, geometry.c_lanes.data() + row);
    range = range / 1000.0f;
    const lanes::Floats p = range - origin;
    lanes::Floats x = M(0, 0) * a + M(0, 1) * b, y = M(1, 0) * a + M(1, 1) * b, z = c;
    if (!upright) {
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
  ColumnPixels pixels{&frame.range[ret][first], &frame.reflectivity[ret][first], frame.rows};
  std::array<std::uint32_t, FiredBeams::most> range;
  std::array<std::uint8_t, FiredBeams::most> reflectivity;
  if (frame.rows % lanes::count != 0) {
    // The last lanes would reach into the next column, or beyond the last one.
    range.fill(0);
    reflectivity.fill(0);
    std::copy_n(pixels.range, frame.rows, range.begin());
    std::copy_n(pixels.reflectivity, frame.rows, reflectivity.begin());
    pixels = {range.data(), reflectivity.data(), frame.rows};
  }
  FiredBeams beams;
  project_column(geometry, column, pixels, beams);
  // All rows are measured at once.
  writer.add(beams, {pixels.range, pixels.reflectivity, rows.ring.data(), nullptr,
                     static_cast<std::uint32_t>(column), static_cast<std::int64_t>(frame.timestamp[column]),
                     frame.rows});
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
