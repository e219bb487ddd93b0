/// @file Which pose of the board to show next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/features/sights.h"
#include "core/guidance/pair_model.h"
#include "core/session/calibration.h"
#include "core/session/rig.h"

namespace ca2 {

/// The pose that would teach the most, in words and numbers.
struct NextPose {
  std::string words;   ///< "left and high, 2.5 m away, facing 30 degrees right of the camera"
  std::string camera;  ///< the pose is in this camera's frame
  Pose T_camera_board;
  double sigma_translation = 0;  ///< m, expected after it; infinite where there is no answer yet
  double sigma_rotation = 0;     ///< rad
};

/// The pose within sight of both sensors of the rig's worst known camera-LiDAR pair that lowers its sigmas
/// most against the target. `lidars`: by index, in the rig's order; missing ones see everything. Nothing
/// where no such pose is found.
std::optional<NextPose> suggest_next_pose(const Rig& rig, const Calibration& calibration,
                                          const std::vector<ViewSights>& views,
                                          const std::vector<ElevationRange>& lidars,
                                          const SigmaTarget& target);

/// Before there is an answer: the pose whose normal differs most from those of the views. Nothing where no
/// camera has intrinsics.
std::optional<NextPose> suggest_first_pose(const Rig& rig, const std::vector<ViewSights>& views);

/// A place and a direction as a person is told them: the camera sees right and left.
std::string pose_in_words(const Pose& T_camera_board);

}  // namespace ca2
