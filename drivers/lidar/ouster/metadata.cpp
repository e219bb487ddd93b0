#include "drivers/lidar/ouster/metadata.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/io/files.h"
#include "core/types/counted.h"
#include "core/types/text.h"
#include "drivers/lidar/ouster/metadata_defaults.h"
#include "drivers/lidar/ouster/profile.h"

namespace ca2 {
namespace {

using Json = nlohmann::json;

constexpr std::array sections{"sensor_info",   "beam_intrinsics",   "imu_intrinsics",    "lidar_intrinsics",
                              "config_params", "lidar_data_format", "calibration_status"};
constexpr int max_pixels = 512;
constexpr int max_columns = 16384;
constexpr double max_offset = 1e4;  // mm
constexpr const char* no_real_sensor =
    "that is no real sensor's: save it again from the sensor's http://SENSOR/api/v1/sensor/metadata";

/// Looks a key up wherever the two layouts keep it, and notes what is wrong with its value.
class Reader {
 public:
  Reader(const Json& root, std::string where, std::vector<Problem>& problems)
      : root_(root), where_(std::move(where)), problems_(problems) {}

  /// The value of `key` in the first of `places` that is an object ("" is the root); nullptr: nowhere. Old
  /// firmware answers a whole section with the text of an error: such a section counts as absent.
  const Json* find(std::initializer_list<const char*> places, const char* key) const {
    for (const char* place : places) {
      const Json* object = &root_;
      if (*place != '\0') {
        const auto found = root_.find(place);
        if (found == root_.end()) continue;
        object = &*found;
      }
      if (!object->is_object()) continue;
      const auto value = object->find(key);
      if (value != object->end() && !value->is_null()) return &*value;
    }
    return nullptr;
  }

  void wrong(const std::string& key, const std::string& what, const std::string& hint = {}) const {
    problems_.push_back({where_, key + ": " + what, hint});
  }

  std::string text(std::initializer_list<const char*> places, const char* key) const {
    const Json* value = find(places, key);
    return value && value->is_string() ? value->get<std::string>() : std::string();
  }

  /// An integer in [low, high]; `fallback` when absent.
  int integer(std::initializer_list<const char*> places, const char* key, int low, int high,
              int fallback) const {
    const Json* value = find(places, key);
    if (!value) return fallback;
    return checked_integer(*value, key, low, high).value_or(fallback);
  }

  std::optional<int> checked_integer(const Json& value, const char* key, int low, int high) const {
    // A number beyond 64 bits is a double to the parser, so compare as a double before converting.
    const double number = value.is_number() ? value.get<double>() : NAN;
    if (!(number >= low && number <= high) || number != std::floor(number)) {
      wrong(key, "must be an integer from " + std::to_string(low) + " to " + std::to_string(high));
      return std::nullopt;
    }
    return static_cast<int>(number);
  }

  std::optional<std::vector<double>> numbers(std::initializer_list<const char*> places,
                                             const char* key) const {
    const Json* value = find(places, key);
    if (!value) return std::nullopt;
    std::vector<double> out;
    if (value->is_array()) {
      for (const Json& item : *value) {
        if (item.is_number() && std::isfinite(item.get<double>())) out.push_back(item.get<double>());
      }
    }
    if (!value->is_array() || out.size() != value->size()) {
      wrong(key, "must be a list of finite numbers",
            value->is_array() && !value->empty() && value->front().is_array()
                ? "a list per pixel is a sensor that does not spin, which is not supported"
                : "");
      return std::nullopt;
    }
    return out;
  }

  std::optional<Eigen::Matrix4d> transform(std::initializer_list<const char*> places, const char* key) const {
    const auto values = numbers(places, key);
    if (!values) return std::nullopt;
    if (values->size() != 16) {
      wrong(key, "must have 16 numbers, has " + std::to_string(values->size()));
      return std::nullopt;
    }
    return Eigen::Matrix4d(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values->data()));
  }

 private:
  const Json& root_;
  std::string where_;
  std::vector<Problem>& problems_;
};

/// "1024x10" as columns and revolutions per second.
bool parse_mode(const std::string& mode, int& columns, double& rate) {
  int w = 0, hz = 0;
  const char* end = mode.data() + mode.size();
  const auto [x, error] = std::from_chars(mode.data(), end, w);
  if (error != std::errc() || x == end || *x != 'x') return false;
  const auto [rest, error2] = std::from_chars(x + 1, end, hz);
  if (error2 != std::errc() || rest != end || w <= 0 || w > max_columns || hz <= 0 || hz > 100) return false;
  columns = w;
  rate = hz;
  return true;
}

void read_identity(const Reader& in, OusterMetadata& out) {
  out.prod_line = in.text({"", "sensor_info"}, "prod_line");
  out.firmware = in.text({"", "sensor_info"}, "build_rev");
  out.timestamp_mode = in.text({"config_params", ""}, "timestamp_mode");
  if (const Json* sn = in.find({"", "sensor_info"}, "prod_sn")) {
    const std::string digits = sn->is_string()            ? sn->get<std::string>()
                               : sn->is_number_unsigned() ? sn->dump()
                                                          : "";
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out.serial);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      out.serial = 0;
      out.warnings.push_back("prod_sn is not a number: packets are not checked against it");
    }
  }
  out.init_id =
      static_cast<std::uint32_t>(in.integer({"", "sensor_info"}, "initialization_id", 0, 0xFFFFFF, 0));
  out.lidar_port = in.integer({"", "config_params"}, "udp_port_lidar", 0, 65535, 0);
  out.imu_port = in.integer({"", "config_params"}, "udp_port_imu", 0, 65535, 0);
}

void read_format(const Reader& in, std::size_t angles, OusterMetadata& out) {
  constexpr const char* format = "lidar_data_format";
  out.lidar_mode = in.text({"", "config_params"}, "lidar_mode");
  int mode_columns = 0;
  const bool mode = parse_mode(out.lidar_mode, mode_columns, out.rate);
  if (!out.lidar_mode.empty() && !mode) {
    in.wrong("lidar_mode", "'" + out.lidar_mode + "' is not COLUMNSxHZ, e.g. 1024x10");
  }
  if (!mode) {
    if (const Json* fps = in.find({format, "data_format"}, "fps"); fps && fps->is_number()) {
      const double hz = fps->get<double>();
      if (hz > 0 && hz <= 100) out.rate = hz;
    }
  }
  const int columns = in.integer({format, "data_format"}, "columns_per_frame", 1, max_columns, 0);
  if (columns == 0 && !mode) {
    in.wrong("lidar_mode", "missing, and so is columns_per_frame: how many columns a frame has is not known");
    return;
  }
  out.columns_per_frame = columns > 0 ? columns : mode_columns;
  if (columns > 0 && mode && columns != mode_columns) {
    out.warnings.push_back("lidar_mode " + out.lidar_mode + " does not fit columns_per_frame " +
                           std::to_string(columns) + ", which is used");
  }
  out.pixels_per_column = in.integer({format, "data_format"}, "pixels_per_column", 1, max_pixels, 0);
  if (out.pixels_per_column == 0) {
    out.pixels_per_column = static_cast<int>(std::min<std::size_t>(angles, max_pixels));
    // Old firmware mostly has no such section, and nothing is wrong then.
    if (in.find({""}, format) || in.find({""}, "data_format"))
      out.warnings.push_back("pixels_per_column is missing: taken from the number of beam angles");
  }
  out.columns_per_packet = in.integer({format, "data_format"}, "columns_per_packet", 1, 512, 16);
  out.window_first = 0;
  out.window_last = out.columns_per_frame - 1;
  if (const auto window = in.numbers({format, "data_format"}, "column_window")) {
    const bool fits = window->size() == 2 && (*window)[0] >= 0 && (*window)[1] >= 0 &&
                      (*window)[0] < out.columns_per_frame && (*window)[1] < out.columns_per_frame;
    if (fits) {
      out.window_first = static_cast<int>((*window)[0]);
      out.window_last = static_cast<int>((*window)[1]);
    } else {
      in.wrong("column_window", "must be two measurement ids below columns_per_frame");
    }
  }
  for (const auto& [key, value] :
       {std::pair{"udp_profile_lidar", &out.profile}, std::pair{"udp_profile_imu", &out.imu_profile}}) {
    const std::string name = in.text({format, "data_format", "config_params"}, key);
    if (!name.empty()) *value = name;
  }
  if (out.profile != "OFF" && !find_ouster_profile(out.profile)) {
    in.wrong("udp_profile_lidar", "unknown packet format '" + out.profile + "'",
             "this sensor's firmware is newer than this decoder, or set another profile on it");
  }
  out.fusa_header = in.text({format, "data_format", "config_params"}, "header_type") == "FUSA" ||
                    out.profile.starts_with("FUSA_");
  out.imu_per_packet = in.integer({"imu_data_format"}, "imu_measurements_per_packet", 0, 1024, 0);
}

void read_shifts(const Reader& in, OusterMetadata& out) {
  const auto shifts = in.numbers({"lidar_data_format", "data_format"}, "pixel_shift_by_row");
  if (shifts && shifts->size() == static_cast<std::size_t>(out.pixels_per_column)) {
    for (const double shift : *shifts) {
      out.pixel_shift.push_back(static_cast<int>(std::clamp(shift, -1.0 * max_columns, 1.0 * max_columns)));
    }
    return;
  }
  if (shifts)
    out.warnings.push_back("pixel_shift_by_row has not one number per row: derived from the angles");
  out.pixel_shift = default_pixel_shift(out.azimuth, out.columns_per_frame);
}

bool is_transform(const Eigen::Matrix4d& m) {
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  return (R.transpose() * R).isIdentity(1e-3) && R.determinant() > 0 &&
         m.topRightCorner<3, 1>().cwiseAbs().maxCoeff() <= max_offset;
}

/// Angles of which points would be made that nobody can use.
void check_angles(const Reader& in, const OusterMetadata& out) {
  const auto beyond = [](const std::vector<double>& angles, double most) {
    return std::any_of(angles.begin(), angles.end(), [&](double angle) { return std::abs(angle) > most; });
  };
  if (beyond(out.altitude, 90))
    in.wrong("beam_altitude_angles", "must be from -90 to 90 degrees", no_real_sensor);
  if (beyond(out.azimuth, 360))
    in.wrong("beam_azimuth_angles", "must be from -360 to 360 degrees", no_real_sensor);
  const auto [least, most] = std::minmax_element(out.altitude.begin(), out.altitude.end());
  if (out.altitude.size() > 1 && *least == *most) {
    in.wrong("beam_altitude_angles",
             "all " + std::to_string(out.altitude.size()) + " beams have the same, " +
                 formatted("%g degrees", *least),
             no_real_sensor);
  }
}

void read_geometry(const Reader& in, OusterMetadata& out) {
  constexpr const char* beams = "beam_intrinsics";
  if (const auto m = in.transform({beams, ""}, "beam_to_lidar_transform")) {
    out.beam_origin_x = (*m)(0, 3);
    out.beam_origin_z = (*m)(2, 3);
  } else if (const Json* offset = in.find({beams, ""}, "lidar_origin_to_beam_origin_mm");
             offset && offset->is_number()) {
    out.beam_origin_x = offset->get<double>();
  } else {
    out.beam_origin_x = default_beam_origin_mm(out.prod_line);
  }
  out.lidar_to_sensor =
      in.transform({"lidar_intrinsics", ""}, "lidar_to_sensor_transform").value_or(default_lidar_to_sensor());
  out.imu_to_sensor =
      in.transform({"imu_intrinsics", ""}, "imu_to_sensor_transform").value_or(default_imu_to_sensor());
  for (const auto& [key, matrix] : {std::pair{"lidar_to_sensor_transform", &out.lidar_to_sensor},
                                    std::pair{"imu_to_sensor_transform", &out.imu_to_sensor}}) {
    if (!is_transform(*matrix))
      in.wrong(key, "is no rotation with a translation of less than 10 m", no_real_sensor);
  }
  if (std::max(std::abs(out.beam_origin_x), std::abs(out.beam_origin_z)) > max_offset) {
    in.wrong("beam_to_lidar_transform", "the beams begin more than 10 m off", no_real_sensor);
  }
}

/// "line:column" of a byte of the text.
std::string place(const std::string& text, std::size_t byte) {
  const std::string_view before(text.data(), std::min(byte, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const auto newline = before.rfind('\n');
  const std::size_t column = before.size() - (newline == before.npos ? 0 : newline + 1);
  return std::to_string(line) + ":" + std::to_string(std::max<std::size_t>(column, 1));
}

}  // namespace

Result<OusterMetadata> parse_ouster_metadata(const std::string& text, const std::string& where) {
  Json root;
  try {
    root = Json::parse(text);
  } catch (const Json::exception& error) {
    const auto* syntax = dynamic_cast<const Json::parse_error*>(&error);
    return fail(ErrorCode::data, where + (syntax ? ":" + place(text, syntax->byte) : ""), "not valid JSON",
                "save it again from the sensor's http://SENSOR/api/v1/sensor/metadata");
  }
  if (!root.is_object()) return fail(ErrorCode::data, where, "not a JSON object");

  std::vector<Problem> problems;
  const Reader in(root, where, problems);
  std::string missing;
  std::size_t present = 0;
  for (const char* section : sections) {
    if (root.contains(section)) {
      ++present;
    } else {
      missing += (missing.empty() ? "" : ", ") + std::string(section);
    }
  }
  if (present > 0 && present < sections.size()) {
    return fail(ErrorCode::data, where,
                "incomplete: it has some sections of a sensor's metadata but not " + missing,
                "save it again from the sensor's http://SENSOR/api/v1/sensor/metadata");
  }

  OusterMetadata out;
  out.altitude = in.numbers({"beam_intrinsics", ""}, "beam_altitude_angles").value_or(std::vector<double>{});
  out.azimuth = in.numbers({"beam_intrinsics", ""}, "beam_azimuth_angles").value_or(std::vector<double>{});
  read_identity(in, out);
  read_format(in, out.altitude.size(), out);
  for (const auto& [key, angles] :
       {std::pair{"beam_altitude_angles", &out.altitude}, std::pair{"beam_azimuth_angles", &out.azimuth}}) {
    if (angles->empty() || angles->size() != static_cast<std::size_t>(out.pixels_per_column)) {
      in.wrong(key, "has " + counted(angles->size(), "angle") + " for " +
                        counted(out.pixels_per_column, "pixel") + " per column");
    }
  }
  check_angles(in, out);
  if (!problems.empty()) return fail(ErrorCode::data, std::move(problems));
  read_shifts(in, out);
  read_geometry(in, out);
  if (!problems.empty()) return fail(ErrorCode::data, std::move(problems));
  return out;
}

bool is_ouster_metadata(const std::string& text) {
  return text.find("\"beam_altitude_angles\"") != std::string::npos;
}

Result<OusterMetadata> read_ouster_metadata(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, 4u << 20);  // real ones have 50 kB
  if (!text) return fail(text.error());
  return parse_ouster_metadata(*text, file.string());
}

int OusterMetadata::valid_columns() const {
  const int span = window_last - window_first + 1;
  return span > 0 ? span : span + columns_per_frame;
}

bool OusterMetadata::in_window(int measurement_id) const {
  if (window_first <= window_last) return measurement_id >= window_first && measurement_id <= window_last;
  return measurement_id >= window_first || measurement_id <= window_last;
}

}  // namespace ca2
