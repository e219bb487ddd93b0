#include <cstring>

#include "core/io/files.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  Scan scan;
  for (int i = 0; i < 5; ++i) {
    const auto f = static_cast<float>(i);
    scan.points.emplace_back(f, -f, 0.5f);
    scan.intensity.push_back(f);
    scan.range.push_back(f);
    scan.ring.push_back(static_cast<std::uint16_t>(i));
    scan.column.push_back(static_cast<std::uint32_t>(2 * i));
    scan.time.push_back(1'700'000'000'000'000'000 + i);
  }
  scan.rings = 16;
  const std::string header = "VERSION 0.7\nFIELDS ring x y z t\nSIZE 2 4 8 4 4\nTYPE U F F F U\n";
  return {encode_pcd(scan).value(), encode_pcd(Scan{}).value(),
          header +
              "COUNT 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n"
              "3 1 2 3 100\n4 nan nan nan 200\n",
          "FIELDS x y z timestamp h\nSIZE 4 4 4 8 1\nTYPE F F F F I\nCOUNT 1 1 1 1 3\nWIDTH 2\nHEIGHT 2\n"
          "DATA ascii\n1 2 3 1e9 0 0 0\n1 2 3 1e9 0 0 0\n1 2 3 0.5 0 0 0\n1e3 -2 +3 0 0 0 0\n"};
}

}  // namespace ca2::fuzz

/// Whatever is read is a consistent scan, and writing it gives the same one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ca2::fuzz::require;
  const auto scan = ca2::parse_pcd({reinterpret_cast<const char*>(data), size}, "input");
  if (!scan) {
    require(!scan.error().problems.empty(), "an error without a problem");
    return 0;
  }
  const auto bytes = ca2::encode_pcd(*scan);
  require(bytes.has_value(), "arrays of different lengths");
  const auto again = ca2::parse_pcd(*bytes, "again");
  require(again.has_value(), "what was written cannot be read");
  require(again->ring == scan->ring && again->column == scan->column && again->time == scan->time,
          "ids changed");
  require(again->rings == scan->rings && again->columns == scan->columns, "the grid changed");
  require(again->size() == scan->size(), "the number of points changed");
  for (std::size_t i = 0; i < scan->size(); ++i) {
    require(scan->points[i].allFinite() || scan->points[i].array().isNaN().all(), "a point half NaN");
    require(std::memcmp(&scan->points[i], &again->points[i], 12) == 0, "a point changed");
  }
  return 0;
}
