// db.xml: what the vendor's programs write with boost's serialization of a class DB. Angles are in degrees,
// lengths in centimetres.
#include <algorithm>
#include <cmath>
#include <locale>
#include <numbers>
#include <optional>
#include <pugixml.hpp>
#include <sstream>

#include "drivers/lidar/velodyne/calibration.h"

namespace ca2 {
namespace {

std::optional<double> number(const pugi::xml_node& parent, const char* name) {
  const pugi::xml_node node = parent.child(name);
  if (!node) return std::nullopt;
  // The classic locale: a decimal point whatever the user's language.
  std::istringstream stream(node.child_value());
  stream.imbue(std::locale::classic());
  double value = NAN;
  stream >> value;
  return stream && std::isfinite(value) ? value : std::optional<double>(NAN);
}

/// Reads the corrections of one <px>; what is missing is 0, what is not a number goes to `problems`.
VelodyneLaser read_laser(const pugi::xml_node& px, const std::string& where, std::vector<Problem>& problems) {
  constexpr double radian = std::numbers::pi / 180;
  constexpr double cm = 0.01;
  VelodyneLaser laser;
  const auto read = [&](const char* name, double unit, double& out) {
    const std::optional<double> value = number(px, name);
    if (value && std::isnan(*value)) problems.push_back({where, std::string(name) + ": not a number", ""});
    if (value) out = *value * unit;
  };
  read("rotCorrection_", radian, laser.rotation);
  read("vertCorrection_", radian, laser.vertical);
  read("distCorrection_", cm, laser.distance);
  read("distCorrectionX_", cm, laser.distance_x);
  read("distCorrectionY_", cm, laser.distance_y);
  read("vertOffsetCorrection_", cm, laser.vertical_offset);
  read("horizOffsetCorrection_", cm, laser.horizontal_offset);
  read("focalDistance_", cm, laser.focal_distance);
  read("focalSlope_", 1, laser.focal_slope);
  return laser;
}

void read_limits(const pugi::xml_node& list, int VelodyneLaser::*member, std::vector<VelodyneLaser>& lasers) {
  std::size_t id = 0;
  for (const pugi::xml_node& item : list.children("item")) {
    if (id == lasers.size()) break;
    const int value = item.text().as_int(-1);
    if (value >= 0 && value <= 255) lasers[id].*member = value;
    ++id;
  }
}

}  // namespace

Result<VelodyneCalibration> parse_velodyne_xml(const std::string& text, int lasers,
                                               const std::string& where) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) {
    return fail(ErrorCode::data, where + ": byte " + std::to_string(parsed.offset),
                std::string("not valid XML: ") + parsed.description());
  }
  const pugi::xml_node db = document.child("boost_serialization").child("DB");
  const pugi::xml_node points = db.child("points_");
  if (!points) {
    return fail(ErrorCode::data, where,
                "not a Velodyne calibration: it has no boost_serialization/DB/points_",
                "give the db.xml that came with the sensor");
  }
  VelodyneCalibration out;
  std::vector<Problem> problems;
  out.lasers.resize(static_cast<std::size_t>(lasers));
  std::vector<bool> seen(out.lasers.size());
  for (const pugi::xml_node& item : points.children("item")) {
    const pugi::xml_node px = item.child("px");
    const std::optional<double> id = number(px, "id_");
    // Units of 16 and 32 lasers list 64 entries of which the first ones count.
    if (!id || !(*id >= 0) || *id >= lasers) continue;
    const auto at = static_cast<std::size_t>(*id);
    if (seen[at]) problems.push_back({where, "laser " + std::to_string(at) + " is listed twice", ""});
    seen[at] = true;
    out.lasers[at] = read_laser(px, where + ": laser " + std::to_string(at), problems);
  }
  const auto count = std::count(seen.begin(), seen.end(), true);
  if (count != lasers) {
    problems.push_back({where,
                        "has " + std::to_string(count) + " of the " + std::to_string(lasers) + " lasers",
                        "this is another model's file, or a part of it is missing"});
  }
  read_limits(db.child("minIntensity_"), &VelodyneLaser::min_intensity, out.lasers);
  read_limits(db.child("maxIntensity_"), &VelodyneLaser::max_intensity, out.lasers);
  if (!problems.empty()) return fail(ErrorCode::data, std::move(problems));
  return out;
}

}  // namespace ca2
