#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/io/files.h"
#include "core/io/pcd_header.h"
#include "core/types/counted.h"

namespace ca2 {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PCD files are little-endian memory");

constexpr std::size_t max_file_bytes = std::size_t{1} << 30;
/// Rows of an organised cloud that may be the rings of a LiDAR; a depth camera's cloud has more.
constexpr std::size_t max_organised_rings = 256;
/// Readers allocate rings x columns: no LiDAR's grid comes near this, a damaged file's may.
constexpr double max_ring = 4095;
constexpr double max_column = (1 << 20) - 1;
constexpr std::size_t max_grid = std::size_t{1} << 26;

enum Role { role_x, role_y, role_z, role_intensity, role_ring, role_column, role_range, role_time, roles };

/// One point's values; those of roles without a field stay 0.
struct Values {
  std::array<double, roles> number{};
  std::int64_t time = 0;       // ns, instead of number[role_time] where the field is an integer
  bool time_overflow = false;  // an unsigned time beyond int64
};

/// Which field plays which role.
struct Layout {
  std::array<const PcdField*, roles> field{};
  bool integer_time = false;

  bool has(Role role) const { return field[role] != nullptr; }
};

Layout make_layout(const PcdHeader& header) {
  static constexpr std::array<std::string_view, roles> names = {"x",    "y",      "z",     "intensity",
                                                                "ring", "column", "range", "time"};
  const auto single = [&](std::string_view name) {
    const PcdField* field = header.find(name);
    return field && field->count == 1 ? field : nullptr;
  };
  Layout layout;
  for (int role = 0; role < roles; ++role) layout.field[role] = single(names[role]);
  for (const char* other : {"t", "timestamp"}) {
    if (!layout.has(role_time)) layout.field[role_time] = single(other);
  }
  layout.integer_time = layout.has(role_time) && layout.field[role_time]->type != 'F';
  return layout;
}

/// Gathers points into a scan and judges their values.
class Gatherer {
 public:
  Gatherer(const PcdHeader& header, const Layout& layout, std::size_t capacity)
      : header_(header), layout_(layout) {
    const bool rows_are_rings = !layout.has(role_ring) && header.height >= 2 &&
                                header.height <= max_organised_rings && header.width >= header.height;
    organised_ = rows_are_rings;
    scan.points.reserve(capacity);
    if (layout.has(role_intensity)) scan.intensity.reserve(capacity);
    if (layout.has(role_range)) scan.range.reserve(capacity);
    if (layout.has(role_ring) || organised_) scan.ring.reserve(capacity);
    if (layout.has(role_column) || organised_) scan.column.reserve(capacity);
    if (layout.has(role_time)) scan.time.reserve(capacity);
  }

  /// What is wrong with the point; empty when it was taken.
  std::string add(const Values& values) {
    const std::size_t index = scan.points.size();
    Eigen::Vector3f point(static_cast<float>(values.number[role_x]),
                          static_cast<float>(values.number[role_y]),
                          static_cast<float>(values.number[role_z]));
    const bool valid = point.allFinite();
    if (!valid) point.setConstant(std::numeric_limits<float>::quiet_NaN());
    scan.points.push_back(point);
    if (layout_.has(role_intensity)) {
      scan.intensity.push_back(static_cast<float>(values.number[role_intensity]));
    }
    if (layout_.has(role_range)) scan.range.push_back(static_cast<float>(values.number[role_range]));
    if (layout_.has(role_ring)) {
      const auto ring = whole(values.number[role_ring], max_ring, valid);
      if (!ring) return "the ring is not a whole number of 0 to 4095";
      scan.ring.push_back(static_cast<std::uint16_t>(*ring));
    } else if (organised_) {
      scan.ring.push_back(static_cast<std::uint16_t>(index / header_.width));
    }
    if (layout_.has(role_column)) {
      const auto column = whole(values.number[role_column], max_column, valid);
      if (!column) return "the column is not a whole number of 0 to 1048575";
      scan.column.push_back(static_cast<std::uint32_t>(*column));
    } else if (organised_) {
      scan.column.push_back(static_cast<std::uint32_t>(index % header_.width));
    }
    return layout_.has(role_time) ? add_time(values, valid) : std::string();
  }

  /// The grid's size, when all points are in; what is wrong with it otherwise.
  std::string finish() {
    const auto size = [](const auto& ids) {
      return ids.empty() ? 0 : static_cast<int>(*std::max_element(ids.begin(), ids.end())) + 1;
    };
    scan.rings = size(scan.ring);
    scan.columns = size(scan.column);
    if (header_.rings > scan.rings && header_.rings <= max_ring + 1) scan.rings = header_.rings;
    if (header_.columns > scan.columns && header_.columns <= max_column + 1) scan.columns = header_.columns;
    if (static_cast<std::size_t>(scan.rings) * static_cast<std::size_t>(scan.columns) > max_grid) {
      return "rings and columns span a grid of " + std::to_string(scan.rings) + " x " +
             std::to_string(scan.columns) + ", more than any LiDAR has";
    }
    return {};
  }

  Scan scan;

 private:
  /// A missing return may carry any id: it counts as 0.
  static std::optional<double> whole(double value, double limit, bool valid) {
    if (value >= 0 && value <= limit && value == std::floor(value)) return value;
    return valid ? std::nullopt : std::optional<double>(0);
  }

  std::string add_time(const Values& values, bool valid) {
    std::int64_t time = values.time;
    bool bad = values.time_overflow;
    if (!layout_.integer_time) {
      // Whole seconds apart from the rest: 1e9 s in ns is exact, the product of a double is not.
      const double seconds = values.number[role_time];
      bad = !(std::abs(seconds) < 9e9);
      if (!bad) {
        const double whole_seconds = std::floor(seconds);
        time = static_cast<std::int64_t>(whole_seconds) * 1'000'000'000 +
               std::llround((seconds - whole_seconds) * 1e9);
      }
    }
    if (bad && valid) return "the time is not a number of seconds or ns since 1970";
    scan.time.push_back(bad ? 0 : time);
    return {};
  }

  const PcdHeader& header_;
  const Layout& layout_;
  bool organised_ = false;
};

template <class T>
T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

double binary_number(const PcdField& field, const char* bytes) {
  switch (field.type) {
    case 'F':
      return field.size == 4 ? static_cast<double>(load<float>(bytes)) : load<double>(bytes);
    case 'U':
      switch (field.size) {
        case 1:
          return load<std::uint8_t>(bytes);
        case 2:
          return load<std::uint16_t>(bytes);
        case 4:
          return load<std::uint32_t>(bytes);
        default:
          return static_cast<double>(load<std::uint64_t>(bytes));
      }
    default:
      switch (field.size) {
        case 1:
          return load<std::int8_t>(bytes);
        case 2:
          return load<std::int16_t>(bytes);
        case 4:
          return load<std::int32_t>(bytes);
        default:
          return static_cast<double>(load<std::int64_t>(bytes));
      }
  }
}

Result<Scan> read_binary(std::string_view body, const PcdHeader& header, const std::string& name) {
  const Layout layout = make_layout(header);
  const std::size_t stride = header.bytes_per_point;
  const std::size_t present = body.size() / stride;
  if (present < header.points) {
    return fail(ErrorCode::data, name,
                "is cut short: the header promises " + counted(header.points, "point") + " of " +
                    counted(stride, "byte") + ", " + std::to_string(present) + " are there");
  }
  // A line end behind the data is harmless; a whole point more means that the header lies.
  if (present > header.points) {
    return fail(ErrorCode::data, name,
                "has " + counted(body.size() - header.points * stride, "byte") + " more than the header's " +
                    counted(header.points, "point") + " of " + counted(stride, "byte"));
  }
  Gatherer gatherer(header, layout, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    const char* point = body.data() + i * stride;
    Values values;
    for (int role = 0; role < roles; ++role) {
      const PcdField* field = layout.field[role];
      if (!field) continue;
      if (role != role_time || !layout.integer_time) {
        values.number[role] = binary_number(*field, point + field->offset);
      } else if (field->size == 8) {
        values.time = load<std::int64_t>(point + field->offset);
        values.time_overflow = field->type == 'U' && values.time < 0;
      } else {
        values.time = static_cast<std::int64_t>(binary_number(*field, point + field->offset));
      }
    }
    const std::string wrong = gatherer.add(values);
    if (!wrong.empty()) return fail(ErrorCode::data, name, "point " + std::to_string(i) + ": " + wrong);
  }
  const std::string wrong = gatherer.finish();
  if (!wrong.empty()) return fail(ErrorCode::data, name, wrong);
  return std::move(gatherer.scan);
}

/// A number of any spelling that writers of PCD use; false when it is none.
bool ascii_number(std::string_view word, double& value) {
  if (word.front() == '+') word.remove_prefix(1);
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc() && stop == end) return true;
  value = std::numeric_limits<double>::quiet_NaN();
  if (error == std::errc::result_out_of_range) return stop == end;
  // "nan(ind)", "-nan", "NaN": what C libraries print for a missing return.
  if (!word.empty() && word.front() == '-') word.remove_prefix(1);
  return word.size() >= 3 && (word[0] | 0x20) == 'n' && (word[1] | 0x20) == 'a' && (word[2] | 0x20) == 'n';
}

class AsciiReader {
 public:
  AsciiReader(std::string_view body, const PcdHeader& header, const std::string& name)
      : at_(body.data()), end_(body.data() + body.size()), header_(header), name_(name) {
    layout_ = make_layout(header);
    role_of_.assign(header.values_per_point, roles);
    for (int role = 0; role < roles; ++role) {
      if (layout_.field[role]) role_of_[layout_.field[role]->first] = static_cast<Role>(role);
    }
  }

  Result<Scan> read() {
    // A value takes two bytes at least: a header cannot make us reserve more than the file could hold.
    const std::size_t possible = static_cast<std::size_t>(end_ - at_) / (2 * header_.values_per_point) + 1;
    Gatherer gatherer(header_, layout_, std::min(header_.points, possible));
    line_ = header_.body_line;
    for (; at_ < end_; ++line_) {
      Values values;
      std::size_t count = 0;
      std::string wrong = read_line(values, count);
      if (count == 0 && wrong.empty()) continue;
      if (wrong.empty() && gatherer.scan.size() == header_.points) {
        wrong = "there are more points than the header's " + std::to_string(header_.points);
      }
      if (wrong.empty()) wrong = gatherer.add(values);
      if (!wrong.empty()) return fail(ErrorCode::data, place(), wrong);
    }
    if (gatherer.scan.size() < header_.points) {
      return fail(ErrorCode::data, place(),
                  "is cut short: the header promises " + counted(header_.points, "point") + ", " +
                      std::to_string(gatherer.scan.size()) + " are there");
    }
    const std::string wrong = gatherer.finish();
    if (!wrong.empty()) return fail(ErrorCode::data, name_, wrong);
    return std::move(gatherer.scan);
  }

 private:
  std::string place() const { return name_ + ":" + std::to_string(line_); }

  /// Reads to behind the next line end; `count` is 0 for a blank line.
  std::string read_line(Values& values, std::size_t& count) {
    std::string wrong;
    while (at_ < end_ && *at_ != '\n') {
      if (*at_ == ' ' || *at_ == '\t' || *at_ == '\r') {
        ++at_;
        continue;
      }
      const char* begin = at_;
      while (at_ < end_ && *at_ != ' ' && *at_ != '\n' && *at_ != '\t' && *at_ != '\r') ++at_;
      const std::string_view word(begin, static_cast<std::size_t>(at_ - begin));
      if (count < role_of_.size() && role_of_[count] != roles && !take(role_of_[count], word, values) &&
          wrong.empty()) {
        wrong = "value " + std::to_string(count + 1) + " is not a number";
      }
      ++count;
    }
    if (at_ < end_) ++at_;
    if (wrong.empty() && count != 0 && count != role_of_.size()) {
      wrong = "the point has " + std::to_string(count) + " values, the header's fields have " +
              std::to_string(role_of_.size());
    }
    return wrong;
  }

  bool take(Role role, std::string_view word, Values& values) const {
    if (role != role_time || !layout_.integer_time) return ascii_number(word, values.number[role]);
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), values.time);
    values.time_overflow = error == std::errc::result_out_of_range;
    return stop == word.data() + word.size() && error != std::errc::invalid_argument;
  }

  const char* at_;
  const char* end_;
  const PcdHeader& header_;
  const std::string& name_;
  Layout layout_;
  std::vector<Role> role_of_;  // of each value of a point; `roles`: skipped
  std::size_t line_ = 0;
};

}  // namespace

Result<Scan> parse_pcd(std::string_view content, const std::string& name) {
  const Result<PcdHeader> header = parse_pcd_header(content, name);
  if (!header) return fail(header.error());
  std::vector<Problem> problems;
  for (const char* axis : {"x", "y", "z"}) {
    const PcdField* field = header->find(axis);
    if (!field || field->count != 1) {
      problems.push_back({name, std::string("has no field ") + axis + " of one value per point", {}});
    }
  }
  if (!problems.empty()) return fail(ErrorCode::data, std::move(problems));
  const std::string_view body = content.substr(header->body);
  return header->data == PcdData::ascii ? AsciiReader(body, *header, name).read()
                                        : read_binary(body, *header, name);
}

Result<Scan> read_pcd(const std::filesystem::path& file) {
  const Result<std::string> content = read_text(file, max_file_bytes);
  if (!content) return fail(content.error());
  return parse_pcd(*content, file.string());
}

}  // namespace ca2
