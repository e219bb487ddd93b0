#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/features/lidar_sights.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

constexpr int columns = 48;

enum Form : std::uint8_t { grid = 0, unordered = 1, raw = 2 };

/// A range per byte, 0 where there is no return, ring by ring.
Scan scan_of_ranges(const std::uint8_t* data, std::size_t size, bool ids) {
  Scan scan;
  const auto rings = static_cast<int>(size / columns);
  for (int ring = 0; ring < rings; ++ring) {
    for (int column = 0; column < columns; ++column) {
      const std::uint8_t byte = data[ring * columns + column];
      if (byte == 0) continue;
      const float range = 0.04f * byte, azimuth = 0.02f * static_cast<float>(column - columns / 2),
                  elevation = 0.03f * static_cast<float>(ring - rings / 2);
      scan.points.emplace_back(range * std::cos(elevation) * std::cos(azimuth),
                               range * std::cos(elevation) * std::sin(azimuth), range * std::sin(elevation));
      if (!ids) continue;
      scan.ring.push_back(static_cast<std::uint16_t>(ring));
      scan.column.push_back(static_cast<std::uint32_t>(column));
      scan.range.push_back(range);
    }
  }
  if (ids) scan.rings = rings, scan.columns = columns;
  return scan;
}

/// Points as they are, with ids as they are: what a file may hold.
Scan scan_of_points(const std::uint8_t* data, std::size_t size) {
  Scan scan;
  constexpr std::size_t bytes = 14;
  for (; size >= bytes; data += bytes, size -= bytes) {
    Eigen::Vector3f p;
    std::memcpy(p.data(), data, 12);
    if (!p.allFinite()) p.setConstant(std::numeric_limits<float>::quiet_NaN());
    scan.points.push_back(p);
    scan.ring.push_back(data[12]);
    scan.column.push_back(data[13]);
    scan.rings = std::max(scan.rings, data[12] + 1);
    scan.columns = std::max(scan.columns, data[13] + 1);
  }
  return scan;
}

}  // namespace

/// A plate before a wall; the first byte chooses how the scan is made of the others.
std::vector<std::string> seeds() {
  constexpr int rings = 24;
  std::string room(1, static_cast<char>(grid)), points(1, static_cast<char>(raw));
  for (int ring = 0; ring < rings; ++ring) {
    for (int column = 0; column < columns; ++column) {
      const bool plate = ring > 6 && ring < 17 && column > 14 && column < 30;
      room += static_cast<char>(plate ? 38 : 120);
      if (ring % 4 != 0 || column % 2 != 0) continue;
      const float p[3] = {plate ? 1.5f : 5.0f, 0.03f * static_cast<float>(column - 22),
                          0.045f * static_cast<float>(ring - 12)};
      points.append(reinterpret_cast<const char*>(p), 12);
      points += {static_cast<char>(ring), static_cast<char>(column)};
    }
  }
  std::string alone = room;
  alone[0] = static_cast<char>(unordered);
  return {room, alone, points};
}

}  // namespace ca2::fuzz

/// Whatever a scan holds, candidates are planes with finite numbers and the returns that they had.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  if (size == 0) return 0;
  static const Board board = [] {
    Board usual;
    usual.type = find_board_type("checkerboard");
    usual.columns = 8;
    usual.rows = 6;
    usual.square = 0.06;
    usual.outline = Outline{0.6, 0.45, {0, 0}};
    return usual;
  }();
  const int form = data[0] % 3;
  const Scan scan = form == fuzz::raw ? fuzz::scan_of_points(data + 1, size - 1)
                                      : fuzz::scan_of_ranges(data + 1, size - 1, form == fuzz::grid);
  for (const LidarSight& sight : find_sights(scan, board)) {
    fuzz::require(std::abs(sight.plane.normal.norm() - 1) < 1e-6 && std::isfinite(sight.plane.offset),
                  "a plane");
    fuzz::require(sight.center.allFinite() && std::isfinite(sight.rms), "no place");
    fuzz::require(sight.on_board.size() + sight.around.size() <= scan.size(), "more returns than there are");
  }
  return 0;
}
