/// @file Is the board held still now, and in which sensors?
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/capture/camera_track.h"
#include "core/capture/lidar_track.h"
#include "core/capture/options.h"

namespace ca2 {

/// What the sensors have seen lately, in the rig's order.
struct Tracks {
  std::vector<std::string> camera_names, lidar_names;
  std::vector<CameraTrack> cameras;
  std::vector<LidarTrack> lidars;
};

struct Assessment {
  enum class Phase {
    absent,   ///< no camera sees the board
    moving,   ///< it moves, or stopped just now
    holding,  ///< it is still, but not for long enough
    ready,    ///< it has been still for the dwell in every camera that sees it, and the LiDARs have had time
  };
  Phase phase = Phase::absent;
  std::string reason;
  double progress = 0;      ///< of the dwell
  std::int64_t since = 0;   ///< ns: from here to `newest` it is still in every camera that sees it
  std::int64_t newest = 0;  ///< ns
  std::vector<std::optional<CameraStillness>> cameras;  ///< nothing: does not see the board
};

Assessment assess(const Tracks& tracks, const CaptureOptions& options, std::int64_t now);

/// Why a camera that is too slow is in no view.
std::string too_slow_text(const std::string& name, const CameraTrack& camera);

/// Tracks reach back so far that a hold before the slowest camera fits.
void look_back_far_enough(Tracks& tracks, const CaptureOptions& options, std::int64_t now);

/// Lets go of the pictures and scans that can be in no view any more: those of before the hold, and those of
/// before `decided`, when it was decided what becomes of the hold. A second of a rig's pictures is a hundred
/// megabytes. Of a hold that goes on undecided, a dwell is kept in any case, and of what is older as much as
/// fits into `budget` bytes, all sensors together.
void release_unneeded(Tracks& tracks, const CaptureOptions& options, const Assessment& assessment,
                      std::optional<std::int64_t> decided, std::size_t budget = 64'000'000);

}  // namespace ca2
