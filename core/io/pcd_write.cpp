#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/io/files.h"

namespace ca2 {
namespace {

constexpr std::size_t points_per_piece = 32768;

/// A field of the file and where its values lie in memory.
struct Column {
  const char* name;
  char type;
  std::size_t size;    // bytes
  const char* values;  // of the first point
  std::size_t step;    // bytes from one point's value to the next
};

using Columns = std::vector<Column>;
using Scans = std::span<const Scan* const>;

/// The arrays that the scan has, in the order of the fields.
Columns columns_of(const Scan& scan) {
  Columns columns;
  const auto* xyz = reinterpret_cast<const char*>(scan.points.data());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    static constexpr const char* names[] = {"x", "y", "z"};
    columns.push_back({names[axis], 'F', 4, xyz ? xyz + 4 * axis : nullptr, sizeof(Eigen::Vector3f)});
  }
  const auto add = [&](const char* name, char type, const auto& values) {
    using Value = typename std::remove_reference_t<decltype(values)>::value_type;
    if (values.empty()) return;
    columns.push_back(
        {name, type, sizeof(Value), reinterpret_cast<const char*>(values.data()), sizeof(Value)});
  };
  add("intensity", 'F', scan.intensity);
  add("ring", 'U', scan.ring);
  add("column", 'U', scan.column);
  add("range", 'F', scan.range);
  add("time", 'I', scan.time);
  return columns;
}

/// Those that all of them have.
void keep_common(std::vector<Columns>& all) {
  const auto missing_in = [](const Columns& columns, const Column& wanted) {
    const auto same = [&](const Column& column) { return std::strcmp(column.name, wanted.name) == 0; };
    return std::none_of(columns.begin(), columns.end(), same);
  };
  for (const Columns& some : all) {
    for (Columns& other : all)
      std::erase_if(other, [&](const Column& column) { return missing_in(some, column); });
  }
}

std::string header_of(Scans scans, const Columns& columns) {
  std::size_t size = 0;
  int rings = 0, grid_columns = 0;
  for (const Scan* scan : scans) {
    size += scan->size();
    rings = std::max(rings, scan->rings);
    grid_columns = std::max(grid_columns, scan->columns);
  }
  std::string fields = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";
  for (const Column& column : columns) {
    fields += std::string(" ") + column.name;
    sizes += " " + std::to_string(column.size);
    types += std::string(" ") + column.type;
    counts += " 1";
  }
  const std::string points = std::to_string(size);
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\n";
  if (rings > 0 || grid_columns > 0) {
    header += "# grid " + std::to_string(rings) + " " + std::to_string(grid_columns) + "\n";
  }
  return header + "VERSION 0.7\n" + fields + "\n" + sizes + "\n" + types + "\n" + counts + "\nWIDTH " +
         points + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA binary\n";
}

/// The column's values of some points, `stride` bytes from one to the next.
template <class Value>
void put(const Column& column, std::size_t first, std::size_t count, char* to, std::size_t stride) {
  const char* from = column.values + first * column.step;
  for (std::size_t i = 0; i < count; ++i, from += column.step, to += stride)
    std::memcpy(to, from, sizeof(Value));
}

void put_column(const Column& column, std::size_t first, std::size_t count, char* to, std::size_t stride) {
  switch (column.size) {
    case 2:
      return put<std::uint16_t>(column, first, count, to, stride);
    case 4:
      return put<std::uint32_t>(column, first, count, to, stride);
    default:
      return put<std::uint64_t>(column, first, count, to, stride);
  }
}

}  // namespace

Result<void> encode_pcd(Scans scans, const PieceSink& sink) {
  std::vector<Columns> columns;
  for (const Scan* scan : scans) {
    const auto fits = [&](std::size_t size) { return size == 0 || size == scan->size(); };
    if (!fits(scan->intensity.size()) || !fits(scan->range.size()) || !fits(scan->ring.size()) ||
        !fits(scan->column.size()) || !fits(scan->time.size())) {
      return fail(ErrorCode::internal, "", "a scan whose arrays have different lengths");
    }
    if (!scan->empty()) columns.push_back(columns_of(*scan));
  }
  keep_common(columns);
  const Columns fields = columns.empty() ? columns_of(Scan{}) : columns.front();
  std::size_t stride = 0;
  for (const Column& column : fields) stride += column.size;
  bool wanted = sink(header_of(scans, fields));
  std::string piece;
  auto of_scan = columns.begin();
  for (const Scan* scan : scans) {
    if (scan->empty()) continue;
    for (std::size_t first = 0; wanted && first < scan->size(); first += points_per_piece) {
      const std::size_t count = std::min(points_per_piece, scan->size() - first);
      piece.resize(stride * count);
      char* to = piece.data();
      for (const Column& column : *of_scan) {
        put_column(column, first, count, to, stride);
        to += column.size;
      }
      wanted = sink(piece);
    }
    ++of_scan;
  }
  return {};
}

Result<std::string> encode_pcd(const Scan& scan) {
  std::string content;
  const Scan* const only[] = {&scan};
  const auto encoded = encode_pcd(only, [&](std::string_view piece) {
    content += piece;
    return true;
  });
  return encoded ? Result<std::string>(std::move(content)) : fail(encoded.error());
}

Result<void> write_pcd(const std::filesystem::path& file, const Scan& scan) {
  const Result<std::string> content = encode_pcd(scan);
  if (!content) return fail(content.error());
  return write_atomically(file, *content);
}

}  // namespace ca2
