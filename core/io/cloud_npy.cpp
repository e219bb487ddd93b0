/// NumPy's .npy: one array of N x 3 or more numbers, rows first, little-endian.
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>

#include "core/io/cloud_files.h"
#include "core/types/counted.h"

namespace ca2 {
namespace {

/// The text of a value in the header's dictionary, from after "'key':" on.
std::string_view value_of(std::string_view header, std::string_view key) {
  const std::size_t at = header.find("'" + std::string(key) + "'");
  if (at == std::string_view::npos) return {};
  const std::size_t colon = header.find(':', at);
  if (colon == std::string_view::npos) return {};
  const std::size_t start = header.find_first_not_of(' ', colon + 1);
  return start == std::string_view::npos ? std::string_view() : header.substr(start);
}

}  // namespace

Result<Scan> parse_npy(std::string_view content, const std::string& name) {
  static_assert(std::endian::native == std::endian::little);
  const auto wrong = [&](const std::string& what) {
    return fail(ErrorCode::data, name, what, "save it by numpy.save as a float array of N x 3 or N x 4");
  };
  if (content.size() < 12 || content.substr(0, 6) != "\x93NUMPY") return wrong("this is no NPY file");
  const int version = static_cast<unsigned char>(content[6]);
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(content[i]));
  };
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t length =
      version == 1 ? byte(8) | byte(9) << 8 : byte(8) | byte(9) << 8 | byte(10) << 16 | byte(11) << 24;
  if (version < 1 || version > 3 || length > content.size() - start)
    return wrong("the NPY header is damaged");
  const std::string_view header = content.substr(start, length);
  const std::string_view type = value_of(header, "descr"), shape = value_of(header, "shape");
  const bool wide = type.starts_with("'<f8'");
  if (!wide && !type.starts_with("'<f4'"))
    return wrong("the array is not of little-endian floats (<f4 or <f8)");
  if (!value_of(header, "fortran_order").starts_with("False"))
    return wrong("the array is stored column by column");
  std::size_t rows = 0, columns = 0;
  if (shape.starts_with("(")) {
    const char* end = shape.data() + shape.size();
    auto read = std::from_chars(shape.data() + 1, end, rows);
    while (read.ptr != end && (*read.ptr == ',' || *read.ptr == ' ')) ++read.ptr;
    read = std::from_chars(read.ptr, end, columns);
    if (read.ec != std::errc() || read.ptr == end || *read.ptr != ')') columns = 0;
  }
  if (columns < 3 || columns > 64) return wrong("the array is not N x 3 or more");
  const std::size_t size = wide ? 8 : 4;
  const std::string_view body = content.substr(start + length);
  if (rows > body.size() / (columns * size))
    return wrong("the file ends before its " + counted(rows, "row") + (rows == 1 ? " does" : " do"));
  Scan scan;
  for (std::size_t row = 0; row < rows; ++row) {
    const auto value = [&](std::size_t column) {
      const char* at = body.data() + (row * columns + column) * size;
      if (wide) {
        double number;
        std::memcpy(&number, at, 8);
        return static_cast<float>(number);
      }
      float number;
      std::memcpy(&number, at, 4);
      return number;
    };
    Eigen::Vector3f p(value(0), value(1), value(2));
    if (!p.allFinite()) p.setConstant(std::numeric_limits<float>::quiet_NaN());
    scan.points.push_back(p);
    if (columns > 3) scan.intensity.push_back(value(3));
  }
  return scan;
}

}  // namespace ca2
