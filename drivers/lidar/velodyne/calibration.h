/// @file The per-laser corrections of a Velodyne: factory constants, or what a unit's own file says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// Corrections of one laser, by its id on the wire (B.6 of the protocol notes; manual: "calibration table").
struct VelodyneLaser {
  double vertical = 0;           ///< rad, elevation
  double rotation = 0;           ///< rad, subtracted from the azimuth of the head
  double distance = 0;           ///< m, added to the measured distance (far point)
  double distance_x = 0;         ///< m, near-point correction at x = 2.40 m
  double distance_y = 0;         ///< m, near-point correction at y = 1.93 m
  double vertical_offset = 0;    ///< m
  double horizontal_offset = 0;  ///< m
  double focal_distance = 0;     ///< m
  double focal_slope = 0;        ///< of the intensity's distance correction; 0: none
  int min_intensity = 0;
  int max_intensity = 255;

  bool operator==(const VelodyneLaser&) const = default;
};

/// What a file says of the distance's resolution is not read: it belongs to the wire format, and the file of
/// the VLS-128 that drivers ship is known to have it wrong (7 mm for 4 mm).
struct VelodyneCalibration {
  std::vector<VelodyneLaser> lasers;
};

/// Ring of each laser: its rank by elevation, 0 at the bottom; equal elevations by id.
std::vector<int> velodyne_rings(const VelodyneCalibration& calibration);

/// The vendor's db.xml (boost serialization of class DB) and the YAML of ROS drivers. `lasers` is how many
/// the model has: an XML of a 16 or 32 laser unit lists 64 entries. Malformed: ErrorCode::data, every
/// problem.
Result<VelodyneCalibration> parse_velodyne_xml(const std::string& text, int lasers, const std::string& where);
Result<VelodyneCalibration> parse_velodyne_yaml(const std::string& text, int lasers,
                                                const std::string& where);

/// Does the text seem to be either of them, sound or not?
bool is_velodyne_calibration(const std::string& text);

/// Either, told apart by the first character that is not white space.
Result<VelodyneCalibration> parse_velodyne_calibration(const std::string& text, int lasers,
                                                       const std::string& where);
Result<VelodyneCalibration> read_velodyne_calibration(const std::filesystem::path& file, int lasers);

/// The YAML that parse_velodyne_yaml reads back exactly (17 digits).
std::string write_velodyne_yaml(const VelodyneCalibration& calibration);

}  // namespace ca2
