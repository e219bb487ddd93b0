/// @file Where a LiDAR sits by one or two views alone: planes leave that open, the plate's rim does not.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/geometry/pose.h"
#include "core/solve/consensus.h"
#include "core/types/result.h"

namespace ca2 {

/// A LiDAR whose place is asked for, and what is known beside it.
struct RimSeedRequest {
  const Board& board;  ///< with an outline
  const std::vector<ViewSights>& views;
  const std::vector<std::optional<Pose>>& T_ref_camera;
  std::size_t lidar = 0;
  const std::vector<std::vector<PatchPlane>>& patches;  ///< the LiDAR's, [view][hypothesis]
  std::string name, reference;                          ///< for messages
  std::optional<Pose> guess;                            ///< T_ref_lidar, roughly, where somebody said it
};

struct RimSeed {
  Pose T_ref_lidar;
  std::vector<int> chosen;  ///< by view: index of the hypothesis that is the board; -1: none
};

/// Every patch whose rim is the plate's, in every way the plate may lie there (half a turn changes no
/// rectangle), gives an answer in every view; those of two views must agree within their covariances. What is
/// left is weighed by that agreement, by the intensities of the print (`ink_log_odds`) and by the guess, when
/// just one answer lies within 30 degrees and 0.5 m of it. Refused (ErrorCode::refused), with words for a
/// person, where nothing is left or another answer is more probable than one in a thousand. The board's
/// front faces camera and LiDAR.
Result<RimSeed> seed_by_rims(const RimSeedRequest& request);

}  // namespace ca2
