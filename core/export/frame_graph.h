/// @file Which frames are known relative to which, and the pose between any two that are connected.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/session/calibration.h"
#include "core/types/result.h"

namespace ca2 {

/// A transform between two named frames (or sensors, which stand for their frames): p_parent = T_parent_child
/// p_child.
struct FrameTransform {
  std::string parent, child;
  Pose T_parent_child;
};

/// How one frame sits in another, as far as the calibration and what was added know.
struct Connection {
  Pose T;  ///< T_parent_child
  /// Right perturbation of T (rotation, translation): zero where only known transforms lead from one to the
  /// other; none where more than one estimated transform does, whose correlation nobody knows.
  std::optional<Matrix6d> covariance = Matrix6d::Zero();
  bool estimated = false;

  Connection inverse() const;
  Connection operator*(const Connection& next) const;
};

/// T_link_optical of REP 103: a camera's link looks along x with z up, its optical frame along z with y down;
/// same origin.
Pose link_from_optical();
/// The name that goes with an optical frame's by custom: "left_camera_optical" -> "left_camera_link",
/// "camera_color_optical_frame" -> "camera_color_link"; NAME_link where the frame does not say "optical".
std::string link_name(const std::string& optical_frame);

class FrameGraph {
 public:
  /// The sensors' frames, connected as the calibration says. ErrorCode::config where two sensors share one
  /// frame.
  static Result<FrameGraph> of(const Calibration& calibration);

  /// Connects two frames, `origin` says who says so. Where both were connected already the two ways must
  /// agree to `same_place`, or it is ErrorCode::config: no exporter may choose between contradicting answers.
  Result<void> add(const FrameTransform& transform, const std::string& origin);
  /// Connects every camera's optical frame to the link that goes with it by custom, where that link is known
  /// and nothing else connects them.
  void connect_links();
  /// Makes `link` the link frame of a camera.
  Result<void> add_link(const std::string& link, const std::string& camera);

  /// The frame that a sensor's name, a frame's name, or the customary name of a camera's link means: a link
  /// of a known camera is added when it is asked for. ErrorCode::usage, with the frames there are, for
  /// anything else.
  Result<std::string> find(const std::string& name);
  bool knows(const std::string& name) const;      ///< a sensor or a frame
  bool is_camera(const std::string& name) const;  ///< a camera, or its optical frame
  /// Frame of a sensor.
  const std::string& frame_of(const std::string& sensor) const { return sensors_.at(sensor); }

  /// ErrorCode::usage where nothing connects the two. The way with the fewest transforms.
  Result<Connection> between(const std::string& parent, const std::string& child) const;
  std::string list() const;  ///< of the frames, for people

 private:
  void connect(const std::string& parent, const std::string& child, const Connection& connection);
  std::string resolved(const std::string& name) const;  ///< a sensor's name becomes its frame

  std::map<std::string, std::string> sensors_;                      ///< frame by sensor
  std::vector<std::string> cameras_;                                ///< sensors that are cameras
  std::map<std::string, std::map<std::string, Connection>> edges_;  ///< [parent][child], both ways
};

/// Two ways between two frames agree when they differ by less: files of people have 6 digits.
inline constexpr double same_place = 1e-5;  ///< m and rad

}  // namespace ca2
