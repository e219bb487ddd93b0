/// @file The answer of a calibration: what result.yaml holds (design.md 3.3).
#pragma once

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/types/result.h"

namespace ca2 {

struct CalibratedTransform {
  std::string parent, child;  ///< sensor names
  std::string parent_frame, child_frame;
  Pose T_parent_child;
  Matrix6d covariance = Matrix6d::Zero();  ///< right perturbation (rotation rad, translation m)

  double sigma_rotation() const { return std::sqrt(covariance.topLeftCorner<3, 3>().trace()); }  ///< rad
  double sigma_translation() const { return std::sqrt(covariance.bottomRightCorner<3, 3>().trace()); }  ///< m
};

struct CalibratedCamera {
  Camera camera;
  bool estimated = false;     ///< false: the given intrinsics, unchanged
  std::vector<double> sigma;  ///< per parameter; 0 for one that was held
};

struct CalibratedLidar {
  double range_bias = 0;  ///< m: measured minus true
  double range_bias_sigma = 0;
  double range_sigma = 0;  ///< m: noise of one return, from the residuals
  bool estimated = false;  ///< the bias was estimated
};

/// How much larger the board's print is than stated: printed over stated length along x and y, less 1.
struct CalibratedPrint {
  Eigen::Vector2d stretch = Eigen::Vector2d::Zero();
  Eigen::Vector2d sigma = Eigen::Vector2d::Zero();
  bool estimated = false;  ///< false: it is believed to be as stated
};

struct CalibratedView {
  int id = 0;
  bool used = false;
  std::string reason;           ///< why not used, for a person; empty when used
  double reprojection_rms = 0;  ///< px
  double plane_rms = 0;         ///< m
};

/// What the answer was made of, as digests in hexadecimal: to tell whether it still is what the session
/// holds.
struct CalibrationInputs {
  std::map<std::string, std::string> rig;  ///< by part: "board", "cameras.NAME", "lidars.NAME", "extrinsics"
  /// By view and sensor. A view without sensors was there, and was not asked for.
  std::map<int, std::map<std::string, std::string>> views;
};

struct Observability {
  std::string verdict;            ///< "good", "weak" or "refused"
  std::string weakest_direction;  ///< in words
  double condition = 0;  ///< largest over smallest standard deviation, translation in m per 1 m lever
};

struct Validation {
  double leave_one_out_translation = 0;  ///< m, rms change of the answer when a view is left out
  double leave_one_out_rotation = 0;     ///< rad
  std::optional<double>
      outline_offset;  ///< m: outline's centre as the LiDAR sees it, beside the camera's, in the plane
  double reprojection_rms = 0;  ///< px
  double range_rms = 0;         ///< m
};

struct Calibration {
  std::string software;  ///< "ca2 0.1.0"
  std::string method;    ///< "joint", "plane_to_plane", "kim"
  std::vector<CalibratedTransform> transforms;
  std::map<std::string, CalibratedCamera> cameras;
  std::map<std::string, CalibratedLidar> lidars;
  CalibratedPrint print;
  Observability observability;
  Validation validation;
  std::vector<CalibratedView> views;
  std::vector<std::string>
      notes;  ///< what a person should know about how the answer came about; may be empty
  std::optional<CalibrationInputs> inputs;  ///< none: not known
};

/// result.yaml's text, 17 significant digits. Every camera has a model.
std::string to_yaml(const Calibration& calibration);
/// The same content as JSON: what `ca2 solve --json` prints. What is not a finite number is null.
std::string to_json(const Calibration& calibration);
/// Reads what to_yaml wrote: the transforms, cameras and LiDARs bit for bit (a rotation that was never in a
/// file: to rounding). The sigmas beside the covariance are derived and not read. ErrorCode::data with every
/// problem.
Result<Calibration> read_calibration(const std::filesystem::path& file);
/// `name` is what errors call the file.
Result<Calibration> parse_calibration(const std::string& text, const std::string& name);

}  // namespace ca2
