/// @file Small pictures of what a sensor sees, the board marked in them.
#pragma once

#include <string>

#include "core/board/board.h"
#include "core/capture/observation.h"
#include "core/types/result.h"

namespace ca2 {

/// One datagram's worth: an LCM message must not be split.
inline constexpr std::size_t max_preview_bytes = 60'000;

struct Preview {
  std::int64_t time = 0;  ///< ns UTC
  int width = 0, height = 0;
  bool sees_board = false;
  std::string jpeg;
};

/// The picture scaled down to `width` px at most, with a cross on every corner.
Result<Preview> preview_of(const CameraObservation& observation, int width);
/// The projection by ID, one pixel per cell or fewer, near is bright; the board in colour.
Result<Preview> preview_of(const LidarObservation& observation, int width);

}  // namespace ca2
