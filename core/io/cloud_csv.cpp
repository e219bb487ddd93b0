/// Columns of numbers, separated by commas, semicolons, tabs or blanks; named by a header line, or x y z
/// [intensity].
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/io/cloud_files.h"

namespace ca2 {
namespace {

std::vector<std::string_view> fields_of(std::string_view line) {
  const bool commas = line.find(',') != std::string_view::npos,
             semicolons = line.find(';') != std::string_view::npos;
  const char separator = semicolons ? ';' : commas ? ',' : ' ';
  std::vector<std::string_view> fields;
  std::size_t at = 0;
  while (at <= line.size()) {
    std::size_t end = separator == ' ' ? line.find_first_of(" \t", at) : line.find(separator, at);
    if (end == std::string_view::npos) end = line.size();
    std::string_view field = line.substr(at, end - at);
    while (!field.empty() && (field.front() == ' ' || field.front() == '\t' || field.front() == '"'))
      field.remove_prefix(1);
    while (!field.empty() &&
           (field.back() == ' ' || field.back() == '\t' || field.back() == '"' || field.back() == '\r')) {
      field.remove_suffix(1);
    }
    if (separator != ' ' || !field.empty()) fields.push_back(field);
    at = end + 1;
  }
  return fields;
}

/// The number, NaN for an empty field; false for anything else.
bool number(std::string_view field, double& value) {
  value = std::numeric_limits<double>::quiet_NaN();
  if (field.empty()) return true;
  if (field.front() == '+') field.remove_prefix(1);
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size();
}

}  // namespace

Result<Scan> parse_cloud_csv(std::string_view content, const std::string& name) {
  Scan scan;
  std::array<int, 5> index{0, 1, 2, -1, -1};  // x y z intensity ring
  std::size_t columns = 0, line_number = 0;
  for (std::size_t at = 0; at < content.size();) {
    std::size_t end = content.find('\n', at);
    if (end == std::string_view::npos) end = content.size();
    const std::string_view line = content.substr(at, end - at);
    at = end + 1;
    ++line_number;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos || line.front() == '#') continue;
    const std::vector<std::string_view> fields = fields_of(line);
    const auto wrong = [&](const std::string& what, const std::string& hint = {}) {
      return fail(ErrorCode::data, name + ":" + std::to_string(line_number), what, hint);
    };
    double value = 0;
    if (columns == 0) {
      columns = fields.size();
      if (columns > 0 && !number(fields.front(), value)) {
        static constexpr std::array names{"x", "y", "z", "intensity", "ring"};
        for (std::size_t k = 0; k < names.size(); ++k) {
          const auto found = std::find(fields.begin(), fields.end(), names[k]);
          index[k] = found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
        }
        if (index[0] < 0 || index[1] < 0 || index[2] < 0) return wrong("the header names no x, y and z");
        continue;
      }
      if (columns < 3)
        return wrong("a line has fewer than three numbers", "give x, y, z and maybe intensity");
      if (columns > 3) index[3] = 3;
    }
    if (fields.size() != columns) {
      return wrong("the line has " + std::to_string(fields.size()) + " values, those before have " +
                   std::to_string(columns));
    }
    std::array<double, 5> values{};
    for (std::size_t k = 0; k < 5; ++k) {
      if (index[k] < 0) continue;
      const std::string_view field = fields[static_cast<std::size_t>(index[k])];
      if (!number(field, values[k])) return wrong("'" + std::string(field) + "' is no number");
    }
    Eigen::Vector3f p(static_cast<float>(values[0]), static_cast<float>(values[1]),
                      static_cast<float>(values[2]));
    if (!p.allFinite()) p.setConstant(std::numeric_limits<float>::quiet_NaN());
    scan.points.push_back(p);
    if (index[3] >= 0) scan.intensity.push_back(static_cast<float>(values[3]));
    if (index[4] >= 0) {
      const double ring = std::isfinite(values[4]) ? std::clamp(values[4], 0.0, 65534.0) : 0;
      scan.ring.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return scan;
}

}  // namespace ca2
