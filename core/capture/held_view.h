/// @file What every sensor has of a hold, and whether it makes a view.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/capture/assess.h"
#include "core/capture/known_extrinsics.h"
#include "core/capture/known_poses.h"
#include "core/session/rig.h"
#include "core/session/session.h"

namespace ca2 {

struct HeldCamera {
  std::vector<const CameraObservation*> pictures;
  std::vector<Corner> corners;    ///< their means
  std::optional<BoardPose> pose;  ///< nothing where the intrinsics are not known
};

struct HeldLidar {
  std::vector<const LidarObservation*> scans;
  const LidarSight* sight = nullptr;  ///< what is held for the board, of the newest scan
  double motion = 0;                  ///< m
};

struct HeldView {
  std::map<std::size_t, HeldCamera> cameras;  ///< those that make the view, by index
  std::map<std::size_t, HeldLidar> lidars;
  std::map<std::string, std::string> gates;  ///< by sensor; empty: passed
  std::string refusal;                       ///< why it is no view; empty: it is one
};

/// What is known beside the sensors' data.
struct HoldContext {
  const Rig& rig;
  const CaptureOptions& options;
  const KnownExtrinsics& extrinsics;
  const std::map<int, Pick>& picks;  ///< by LiDAR
};

/// The hold from `since` to `newest`: gates, and which of the LiDARs' hypotheses is the board. Pointers are
/// into the tracks. `at_once`: a person wants it now; what lay there before may be the board, too.
HeldView collect_view(const Tracks& tracks, const HoldContext& context, std::int64_t since,
                      std::int64_t newest, bool at_once);

/// The view's poses, to compare with others.
ViewPose pose_of(const HeldView& view, const Tracks& tracks);

}  // namespace ca2
