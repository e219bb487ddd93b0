/// @file What the views say about an answer: residuals, coverage, how it settled.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/features/extract.h"
#include "core/session/calibration.h"

namespace ca2 {

struct CornerError {
  int id = 0;
  Eigen::Vector2d pixel;  ///< where it was seen, px
  Eigen::Vector2d error;  ///< seen minus where the board's pose puts it, px
};

struct BoardPointError {
  Eigen::Vector3d point;  ///< LiDAR frame, m
  double error = 0;       ///< measured minus predicted range along the ray, less the bias, m
};

/// One view at the answer.
struct ViewEvidence {
  int id = 0;
  std::map<std::string, Pose> T_camera_board;  ///< by camera, from its picture
  std::map<std::string, std::vector<CornerError>> corners;
  /// By camera and LiDAR: the LiDAR's returns on the board against the board as that camera sees it.
  std::map<std::pair<std::string, std::string>, std::vector<BoardPointError>> points;
};

/// Two cameras against each other: corners of one, placed by its picture, projected into the other.
struct StereoEvidence {
  std::string a, b;
  int views = 0;
  double rms = 0;          ///< px, in b
  Eigen::Vector3d offset;  ///< m: mean of where b sees the board beside where a says, b's frame
};

/// The answer from the first views alone.
struct SettlingStep {
  int views = 0;
  double sigma_translation = 0, sigma_rotation = 0;    ///< m, rad: as estimated then
  double change_translation = 0, change_rotation = 0;  ///< m, rad: to the answer of all
};

struct Evidence {
  std::vector<ViewEvidence> views;  ///< those in use
  std::vector<StereoEvidence> stereo;
  std::map<std::string, std::vector<SettlingStep>>
      settling;  ///< by "camera lidar", of the first camera's pairs
};

/// `views` and `rig` are those of the session, as extract_features gives them.
Evidence gather_evidence(const Extraction& features, const Calibration& calibration);

}  // namespace ca2
