/// @file A first answer for the whole rig, without any guess: which hypotheses are the board, and roughly
/// where the sensors sit.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/geometry/pose.h"
#include "core/types/result.h"

namespace ca2 {

struct RigSeed {
  std::vector<Pose> T_ref_camera;  ///< the first camera is the reference
  std::vector<Pose> T_ref_lidar;
  std::vector<std::vector<int>> chosen;   ///< [view][lidar]: index of the hypothesis, -1: none agrees
  std::vector<std::vector<bool>> turned;  ///< [view][camera]: the corner ids are to be turned by half a turn
};

/// Links the rig's sensors through the views they share, strongest links first. Refused (ErrorCode::refused)
/// with the sensors named when one cannot be linked. `cameras` and `lidars` are names for messages.
/// Asked to stop it gives up soon, and its answer means nothing.
Result<RigSeed> seed_rig(const Board& board, const std::vector<ViewSights>& views,
                         const std::vector<std::string>& cameras, const std::vector<std::string>& lidars,
                         std::uint64_t seed, std::stop_token stop = {});

/// The pose of the board when its pattern is turned by half a turn.
Pose half_turned(const Pose& T_sensor_board);
/// The corner ids of a half-turned pattern: id -> count - 1 - id.
void turn_ids(std::vector<Corner>& corners, int count);

}  // namespace ca2
