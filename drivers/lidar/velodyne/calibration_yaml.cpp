// The YAML that ROS drivers make of db.xml: radians and metres.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/io/files.h"
#include "drivers/lidar/velodyne/calibration.h"

namespace ca2 {
namespace {

struct Key {
  const char* name;
  double VelodyneLaser::*member;
};
constexpr Key keys[] = {
    {"rot_correction", &VelodyneLaser::rotation},
    {"vert_correction", &VelodyneLaser::vertical},
    {"dist_correction", &VelodyneLaser::distance},
    {"dist_correction_x", &VelodyneLaser::distance_x},
    {"dist_correction_y", &VelodyneLaser::distance_y},
    {"vert_offset_correction", &VelodyneLaser::vertical_offset},
    {"horiz_offset_correction", &VelodyneLaser::horizontal_offset},
    {"focal_distance", &VelodyneLaser::focal_distance},
    {"focal_slope", &VelodyneLaser::focal_slope},
};

std::string place(const std::string& where, const YAML::Mark& mark) {
  if (mark.is_null()) return where;
  return where + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
}

bool read_number(const YAML::Node& node, double& out) {
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) return false;
  out = value;
  return true;
}

VelodyneLaser read_laser(const YAML::Node& entry, const std::string& where, std::vector<Problem>& problems) {
  VelodyneLaser laser;
  const auto wrong = [&](const YAML::Node& value, const char* name) {
    problems.push_back({place(where, value.Mark()), std::string(name) + ": not a number in its range", ""});
  };
  for (const Key& key : keys) {
    const YAML::Node value = entry[key.name];
    if (value && !read_number(value, laser.*key.member)) wrong(value, key.name);
  }
  for (const auto& [name, member] : {std::pair{"min_intensity", &VelodyneLaser::min_intensity},
                                     std::pair{"max_intensity", &VelodyneLaser::max_intensity}}) {
    const YAML::Node value = entry[name];
    if (!value) continue;
    double number = 0;
    if (read_number(value, number) && number >= 0 && number <= 255) {
      laser.*member = static_cast<int>(number);
    } else {
      wrong(value, name);
    }
  }
  return laser;
}

Result<VelodyneCalibration> read_document(const YAML::Node& root, int lasers, const std::string& where) {
  if (!root.IsMap() || !root["lasers"] || !root["lasers"].IsSequence()) {
    return fail(ErrorCode::data, where, "not a Velodyne calibration: it has no list 'lasers'");
  }
  VelodyneCalibration out;
  std::vector<Problem> problems;
  out.lasers.resize(static_cast<std::size_t>(lasers));
  std::vector<bool> seen(out.lasers.size());
  for (const YAML::Node& entry : root["lasers"]) {
    double id = -1;
    if (!entry.IsMap() || !entry["laser_id"] || !read_number(entry["laser_id"], id) || id < 0 ||
        id >= lasers) {
      problems.push_back({place(where, entry.Mark()),
                          "a laser needs a laser_id from 0 to " + std::to_string(lasers - 1), ""});
      continue;
    }
    const auto at = static_cast<std::size_t>(id);
    if (seen[at]) {
      problems.push_back(
          {place(where, entry.Mark()), "laser " + std::to_string(at) + " is listed twice", ""});
    }
    seen[at] = true;
    out.lasers[at] = read_laser(entry, where, problems);
  }
  const auto count = std::count(seen.begin(), seen.end(), true);
  if (count != lasers) {
    problems.push_back({where,
                        "has " + std::to_string(count) + " of the " + std::to_string(lasers) + " lasers",
                        "this is another model's file, or a part of it is missing"});
  }
  if (!problems.empty()) return fail(ErrorCode::data, std::move(problems));
  return out;
}

}  // namespace

Result<VelodyneCalibration> parse_velodyne_yaml(const std::string& text, int lasers,
                                                const std::string& where) {
  try {
    return read_document(YAML::Load(text), lasers, where);
  } catch (const YAML::Exception& error) {
    return fail(ErrorCode::data, place(where, error.mark), "not valid YAML: " + error.msg);
  }
}

bool is_velodyne_calibration(const std::string& text) {
  return text.find("boost_serialization") != std::string::npos ||
         text.find("vert_correction") != std::string::npos;
}

Result<VelodyneCalibration> parse_velodyne_calibration(const std::string& text, int lasers,
                                                       const std::string& where) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  const bool xml = first != std::string::npos && text[first] == '<';
  return xml ? parse_velodyne_xml(text, lasers, where) : parse_velodyne_yaml(text, lasers, where);
}

Result<VelodyneCalibration> read_velodyne_calibration(const std::filesystem::path& file, int lasers) {
  const Result<std::string> text = read_text(file, 4u << 20);  // real ones have 50 kB
  if (!text) return fail(text.error());
  return parse_velodyne_calibration(*text, lasers, file.string());
}

std::string write_velodyne_yaml(const VelodyneCalibration& calibration) {
  char line[96];
  std::string out = "num_lasers: " + std::to_string(calibration.lasers.size()) + "\n";
  out += "lasers:\n";
  for (std::size_t id = 0; id < calibration.lasers.size(); ++id) {
    const VelodyneLaser& laser = calibration.lasers[id];
    out += "- laser_id: " + std::to_string(id) + "\n";
    for (const Key& key : keys) {
      std::snprintf(line, sizeof line, "  %s: %.17g\n", key.name, laser.*key.member);
      out += line;
    }
    out += "  min_intensity: " + std::to_string(laser.min_intensity) + "\n";
    out += "  max_intensity: " + std::to_string(laser.max_intensity) + "\n";
  }
  return out;
}

}  // namespace ca2
