/// PLY: ASCII and little-endian binary, vertices first, as its writers do.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>

#include "core/io/cloud_files.h"

namespace ca2 {
namespace {

struct Property {
  std::string name;
  char kind = 'f';  ///< f float, i signed, u unsigned
  std::size_t size = 4;
};

std::optional<Property> property(const std::string& type, const std::string& name) {
  struct Known {
    const char* type;
    char kind;
    std::size_t size;
  };
  static constexpr std::array known{
      Known{"float", 'f', 4}, Known{"float32", 'f', 4}, Known{"double", 'f', 8}, Known{"float64", 'f', 8},
      Known{"char", 'i', 1},  Known{"int8", 'i', 1},    Known{"uchar", 'u', 1},  Known{"uint8", 'u', 1},
      Known{"short", 'i', 2}, Known{"int16", 'i', 2},   Known{"ushort", 'u', 2}, Known{"uint16", 'u', 2},
      Known{"int", 'i', 4},   Known{"int32", 'i', 4},   Known{"uint", 'u', 4},   Known{"uint32", 'u', 4}};
  for (const Known& k : known) {
    if (type == k.type) return Property{name, k.kind, k.size};
  }
  return std::nullopt;
}

double binary_value(const char* at, const Property& p) {
  static_assert(std::endian::native == std::endian::little);
  if (p.kind == 'f') {
    if (p.size == 8) {
      double value;
      std::memcpy(&value, at, 8);
      return value;
    }
    float value;
    std::memcpy(&value, at, 4);
    return value;
  }
  std::uint32_t bits = 0;
  std::memcpy(&bits, at, p.size);
  if (p.kind == 'u') return bits;
  const int unused = 32 - 8 * static_cast<int>(p.size);
  return static_cast<std::int32_t>(bits << unused) >> unused;
}

struct Header {
  bool binary = false;
  std::size_t vertices = 0;
  std::vector<Property> properties;
  std::size_t body = 0;
};

Result<Header> parse_header(std::string_view content, const std::string& name) {
  Header header;
  bool in_vertices = false, format = false;
  std::size_t at = 0;
  for (int line = 1;; ++line) {
    const std::size_t end = content.find('\n', at);
    const auto wrong = [&](const std::string& what) {
      return fail(ErrorCode::data, name + ":" + std::to_string(line), what);
    };
    if (end == std::string_view::npos || line > 1000) return wrong("the PLY header has no end_header");
    std::istringstream words{std::string(content.substr(at, end - at))};
    at = end + 1;
    std::string keyword, a, b;
    words >> keyword >> a >> b;
    if (line == 1 && keyword != "ply") return wrong("this is no PLY file");
    if (keyword == "format") {
      format = a == "ascii" || a == "binary_little_endian";
      header.binary = a != "ascii";
      if (!format) return wrong("the format " + a + " is not supported: ascii and binary_little_endian are");
    } else if (keyword == "element") {
      in_vertices = a == "vertex";
      if (!in_vertices && header.properties.empty()) return wrong("the vertices must come first");
      if (in_vertices) {
        const auto [rest, error] = std::from_chars(b.data(), b.data() + b.size(), header.vertices);
        if (error != std::errc() || rest != b.data() + b.size())
          return wrong("the number of vertices is '" + b + "'");
      }
    } else if (keyword == "property" && in_vertices) {
      const auto known = property(a, b);
      if (!known) return wrong("a vertex property of type '" + a + "' is not supported");
      header.properties.push_back(*known);
    } else if (keyword == "end_header") {
      header.body = at;
      if (!format) return wrong("the header names no format");
      return header;
    }
  }
}

}  // namespace

Result<Scan> parse_ply(std::string_view content, const std::string& name) {
  const Result<Header> header = parse_header(content, name);
  if (!header) return fail(header.error());
  std::array<int, 5> index{-1, -1, -1, -1, -1};  // x y z intensity ring
  std::size_t size = 0;
  std::vector<std::size_t> offsets;
  for (std::size_t i = 0; i < header->properties.size(); ++i) {
    const std::string& field = header->properties[i].name;
    static constexpr std::array fields{"x", "y", "z", "intensity", "ring"};
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (field == fields[k] || (k == 3 && field == "scalar_intensity")) index[k] = static_cast<int>(i);
    }
    offsets.push_back(size);
    size += header->properties[i].size;
  }
  if (index[0] < 0 || index[1] < 0 || index[2] < 0)
    return fail(ErrorCode::data, name, "the vertices have no x, y and z");
  // An ASCII vertex has at least two bytes per value.
  const std::size_t least = header->binary ? size : 2 * header->properties.size();
  if (header->vertices > (content.size() - header->body) / least + 1 ||
      (header->binary && header->vertices * size > content.size() - header->body)) {
    return fail(ErrorCode::data, name,
                "the file ends before its " + std::to_string(header->vertices) + " vertices do");
  }
  Scan scan;
  std::istringstream text;
  if (!header->binary) text.str(std::string(content.substr(header->body)));
  text.imbue(std::locale::classic());
  std::vector<double> values(header->properties.size());
  for (std::size_t v = 0; v < header->vertices; ++v) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::string word;
      if (header->binary) {
        values[i] =
            binary_value(content.data() + header->body + v * size + offsets[i], header->properties[i]);
      } else if (text >> word) {
        // strtod's words for what is not finite are what writers write.
        values[i] = std::strtod(word.c_str(), nullptr);
      } else {
        return fail(ErrorCode::data, name, "the file ends at vertex " + std::to_string(v + 1));
      }
    }
    const auto value = [&](std::size_t k) {
      return static_cast<float>(values[static_cast<std::size_t>(index[k])]);
    };
    Eigen::Vector3f p(value(0), value(1), value(2));
    if (!p.allFinite()) p.setConstant(std::numeric_limits<float>::quiet_NaN());
    scan.points.push_back(p);
    if (index[3] >= 0) scan.intensity.push_back(value(3));
    if (index[4] >= 0) {
      const float ring = std::isfinite(value(4)) ? std::clamp(value(4), 0.0f, 65534.0f) : 0;
      scan.ring.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return scan;
}

}  // namespace ca2
