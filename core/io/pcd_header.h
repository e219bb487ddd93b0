/// @file The header of a PCD file: what its points are made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

struct PcdField {
  std::string name;
  char type = 'F';         ///< F float, U unsigned, I signed
  int size = 4;            ///< bytes of one value
  std::size_t count = 1;   ///< values per point
  std::size_t offset = 0;  ///< bytes from the point's start (binary)
  std::size_t first = 0;   ///< index of its first value among the point's values (ASCII)
};

enum class PcdData { ascii, binary, binary_compressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t width = 0;
  std::size_t height = 1;
  std::size_t points = 0;
  std::size_t values_per_point = 0;
  std::size_t bytes_per_point = 0;
  PcdData data = PcdData::ascii;
  std::size_t body = 0;       ///< where the points begin in the content, bytes
  std::size_t body_line = 1;  ///< line number there
  int rings = 0;              ///< from the comment "# grid RINGS COLUMNS"; 0: not given
  int columns = 0;

  /// The first field of this name, or nullptr.
  const PcdField* find(std::string_view name) const;
};

/// No point has more bytes than this: bounds the arithmetic on hostile headers.
inline constexpr std::size_t max_pcd_point_bytes = 1u << 20;

/// Reads the lines up to and with DATA. All problems are reported, each as "name:line".
Result<PcdHeader> parse_pcd_header(std::string_view content, const std::string& name);

}  // namespace ca2
