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
  /// No LiDAR shares three views with a camera: it took the plates' rims, see `seed_by_rims`.
  bool by_rims = false;
};

/// Roughly known, as somebody said; sensors by index, cameras first.
struct PlaceGuess {
  int a = 0, b = 0;
  Pose T_a_b;
};

struct SeedOptions {
  std::uint64_t seed = 1;
  bool rims = true;                 ///< may rims stand in where views are few?
  std::vector<PlaceGuess> guesses;  ///< only tell apart what the views leave open
  std::stop_token stop = {};
};

/// Links the rig's sensors through the views they share, strongest links first. Refused (ErrorCode::refused)
/// with the sensors named when one cannot be linked. `cameras` and `lidars` are names for messages. One or
/// two views take a board with an outline. Asked to stop it gives up soon, and its answer means nothing.
Result<RigSeed> seed_rig(const Board& board, const std::vector<ViewSights>& views,
                         const std::vector<std::string>& cameras, const std::vector<std::string>& lidars,
                         const SeedOptions& options);

/// [view][camera]: the corners with their ids as the seed settled them, of a board that has `count`.
std::vector<std::vector<std::vector<Corner>>> settled_corners(const std::vector<ViewSights>& views,
                                                              const RigSeed& seed, int count);
/// T_ref_board by view, from the first camera that saw it; the identity where none did.
std::vector<Pose> seeded_boards(const std::vector<ViewSights>& views, const RigSeed& seed);

}  // namespace ca2
