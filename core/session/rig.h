/// @file The rig: which board, cameras and LiDARs there are, as the rig keys of the YAML files say.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/types/result.h"

namespace ca2 {

/// Keys and values of a `source:` mapping: only the daemon and the drivers read them.
using SourceOptions = std::map<std::string, std::string>;

struct RigCamera {
  std::string frame;
  int width = 0;  ///< px; 0: not given, taken from the pictures
  int height = 0;
  std::optional<Camera> intrinsics;      ///< absent: estimated from the views
  std::string model = "pinhole_radtan";  ///< the model to estimate where intrinsics are absent
  SourceOptions source;
};

struct RigLidar {
  std::string frame;
  std::string metadata;     ///< ouster: metadata file, absolute or relative to the rig file; empty: not given
  std::string model;        ///< velodyne: "VLP-16", ...; empty: not given
  std::string calibration;  ///< velodyne: file; empty: the factory table
  SourceOptions source;
};

struct RigExtrinsic {
  std::string parent;  ///< sensor names
  std::string child;
  Pose T_parent_child;
  bool fixed = false;  ///< true: known, not estimated
};

struct Rig {
  Board board;
  std::map<std::string, RigCamera> cameras;  ///< by name
  std::map<std::string, RigLidar> lidars;
  std::vector<RigExtrinsic> extrinsics;
};

/// May a sensor be called this? 1 to 64 letters, digits, _ and -: names become names of files.
bool valid_sensor_name(std::string_view name);

/// Reads the rig keys of a YAML text (design.md 3.1). `file` names it in errors ("file:line:col") and is what
/// relative paths are relative to. `extra_keys` are further top-level keys the kind of file allows. Every
/// problem is reported; unknown keys with the nearest known one as a suggestion. ErrorCode::config.
/// Intrinsics are `intrinsics: {model, parameters}`, or `{model}` alone (to be estimated with that model), or
/// a file of read_intrinsics: `intrinsics: {file, camera}`, or `file` and `camera` beside `frame`; `camera`
/// picks one of a camchain. A sensor without a `frame` has its own name as frame. Names of sensors are made
/// of letters, digits, _ and - and are unique over cameras and LiDARs. Quaternions are normalised; one
/// further than 1e-3 from unit length is refused.
Result<Rig> parse_rig(const std::string& text, const std::filesystem::path& file,
                      const std::vector<std::string>& extra_keys = {});
Result<Rig> read_rig(const std::filesystem::path& file, const std::vector<std::string>& extra_keys = {});

/// The rig as YAML keys, with 17 significant digits, intrinsics written out; parse_rig gives the same rig
/// back, bit for bit (a rotation that did not come from parse_rig: to rounding).
std::string write_rig(const Rig& rig);

/// Intrinsics from a ROS camera_info, Kalibr camchain or OpenCV calibration file, told apart by their keys.
/// `camera` picks one of a camchain ("cam0"); empty: the only one, or an error that lists them.
Result<Camera> read_intrinsics(const std::filesystem::path& file, const std::string& camera = {});

}  // namespace ca2
